"""An answer as text: architectures with their evidence, then calibrations of each."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from api.cli.table_output import prose, table
from api.figures.wording import plural
from api.schema.recommendations import Architecture, Blocked, Calibration, Recommendations
from registry.comparison import labels

_NARROW = 30
_LABEL = 13  # columns before the text of a labelled paragraph
_HEADINGS = ("", "calibration", "survey labels", "advised", "studies", "in flight, deg", "own, deg")
_INDENT = "    "
_NEVER_BUILT = "Measured here, never built"


def text(document: Recommendations, width: int) -> str:
    """Return the architectures of an answer with their evidence, as lines."""
    return "\n".join(itertools.chain(_head(document, width), _body(document, width))) + "\n"


def explanation(blocked: Blocked, width: int) -> str:
    """Return which requirement excludes all architectures, and changes that would help."""
    named = f"{blocked.constraint}: " if blocked.constraint else ""
    said = f"no architecture meets the requirements: {named}{blocked.detail}"
    lines = prose(said, width, "  ")
    for one in blocked.relaxations:
        found = plural(one.architectures, "architecture")
        lines += prose(f"{one.words}: {found}", width, "    ", "  - ")
    return "\n".join(lines)


def _head(document: Recommendations, width: int) -> Iterator[str]:
    shown = len(document.architectures)
    first = "" if shown == document.count else f"first {shown} of "
    count = plural(document.count, "architecture")
    yield from prose(f"{first}{count}, {plural(document.designs, 'calibration')} in all", width)
    yield from prose(document.order, width)
    if document.requirements.get("mission"):
        asked = document.requirements.items()
        named = ", ".join(f"{name} {_plain(value)}" for name, value in asked if name != "mission")
        yield from _paragraph("asked", named, width)
    for note in document.notes:
        yield from _paragraph("note", note, width)
    for card in document.cards:
        said = f"{card.detector} + {card.mask} ({card.words})"
        yield from _paragraph(card.title, said, width)
    for one in document.contradictions:
        yield from _paragraph("contrary", one.sentence, width)


def _body(document: Recommendations, width: int) -> Iterator[str]:
    was_built = True
    for one in document.architectures:
        yield ""
        if was_built and not one.built:
            yield from (_NEVER_BUILT, "")
        was_built = one.built
        yield from _architecture(one, width)


def _architecture(one: Architecture, width: int) -> Iterator[str]:
    rank = "" if one.rank is None else f"{one.rank}{'=' if one.tied else ''}"
    kinds = {"reported": "reports", "measured": "measurement"}
    by = " and ".join(kinds[kind] for kind in one.meets)
    name = f"{one.detector} + {one.mask}"
    yield from prose(f"{name}, by {by}", width, _INDENT, f"{rank:<3} ")
    yield from _paragraph("why", one.reason, width)
    for state in one.evidence:
        judged = {"reported": state.reported, "measured": state.measured, "advised": state.advised}
        said = ", ".join(f"{kind} {found}" for kind, found in judged.items() if found)
        yield from _paragraph("evidence", f"{state.requirement}: {said}", width)
    built = f"{plural(one.studies, 'study', 'studies')}, {plural(one.products, 'product')}"
    yield from _paragraph("built", built, width)
    for advice in one.advised:
        how = f": {advice.how}" if advice.how else ""
        yield from _paragraph("advised", f"{advice.value}{how} ({advice.section_name})", width)
    for measure in one.measures:
        yield from _paragraph("by task", measure.words, width)
    if one.calibrations:
        rows = [_calibration(rank, found) for rank, found in enumerate(one.calibrations, start=1)]
        yield table(rows, _HEADINGS, width, _INDENT, rule=False)
        if rest := one.count - len(one.calibrations):
            yield f"{_INDENT}... and {rest} more"


def _calibration(rank: int, one: Calibration) -> dict[str, str]:
    found = one.measured
    flight, own = "not flown", "not measured"
    if found is not None:
        over = "" if found.field_deg in {None, 360.0} else f" over {found.field_deg:g}"
        own = (
            "availability below 95 %"
            if found.own_error_deg is None
            else f"{found.own_error_deg:.3g}{over}"
        )
        if found.flight_error_deg is not None:
            flight = f"{found.flight_error_deg:.3g}{over}"
    cells = (
        str(rank),
        one.name,
        labels(one.extractor, (*one.compensations, one.model)) or "not in the survey",
        "yes" if one.advised else "no",
        str(len(one.studies)) if one.studies else "none",
        flight,
        own,
    )
    return dict(zip(_HEADINGS, cells, strict=True))


def _plain(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)


def _paragraph(label: str, words: str, width: int) -> Sequence[str]:
    left = f"{_INDENT}{label} ".ljust(_LABEL + 2)
    if width < 2 * _NARROW:  # a column of labels leaves too little beside it
        return prose(f"{label}: {words}", width, f"{_INDENT}  ", _INDENT)
    return prose(words, width, " " * len(left), left)
