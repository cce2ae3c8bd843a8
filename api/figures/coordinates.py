"""Parallel coordinates: year, detector, mask, field of view and accuracy of every sensor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from api import columns as table_columns
from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.coordinates_drawing import Axis, Polyline, Tick, draw_coordinates
from api.figures.figure import Entry, Figure
from registry.flows import LeftOut, Where, allowed_values, flows
from registry.studies import Facts, Study

NAME = "coordinates"
TITLE = "Performance in parallel coordinates"
CAPTION = (
    "Each line is a sensor of a study: when, of what, how far it sees and how accurate it is "
    "said to be."
)
NUMBERS = ("fov_deg", "accuracy_deg")
_COLOURS = {None: "c0", "CSS": "c4", "FSS": "c2", "VFSS": "c3", "UFSS": "c1"}
"""Accuracy class -> colour."""


def coordinates_figure(facts: Facts, addresses: Addresses, where: Where) -> Figure:
    """Return a line for every sensor of the studies that meet `where`."""
    found = flows(("detector", "mask"), where, facts=facts)
    studies = [facts.studies[key] for key in found.studies]
    rows = [row for study in studies for row in _sensors(study, facts, where)]
    axes = _axes(rows, facts)
    lines = [
        Polyline(
            values=tuple(row[axis.name] for axis in axes),
            colour=_COLOURS[row["accuracy"]],
            title=_title(row, facts),
            href=addresses.of([row["study"]], {}, at),
        )
        for at, row in enumerate(rows)
    ]
    classes = [name for name in _COLOURS if any(row["accuracy"] == name for row in rows)]
    entries = [
        Entry(_COLOURS[name], wording.named(facts.taxonomy, "accuracy", name))
        if name
        else Entry(_COLOURS[None], "class of accuracy not known")
        for name in sorted(classes, key=lambda name: (name is None, list(_COLOURS).index(name)))
    ]
    left_out = tuple(
        LeftOut(name, tuple(study.key for study in studies if study.number(name) is None))
        for name in NUMBERS
        if any(study.number(name) is None for study in studies)
    )
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(studies, rows),
        studies=len(studies),
        left_out=left_out,
        columns=table_columns.FIGURE_COORDINATES,
        rows=tuple(rows),
        draw=lambda width: draw_coordinates(axes, lines, entries, width),
    )


def _sensors(study: Study, facts: Facts, where: Where) -> list[dict[str, Any]]:
    """Return a row for each detector and mask of a study that the filters leave; "" is unknown."""
    allowed = allowed_values(where, facts.taxonomy)
    sensors = [
        (detector, mask)
        for detector in study.of("detector") or (None,)
        for mask in study.of("mask") or (None,)
        if study.has_sensor({"detector": detector, "mask": mask})
        and (detector is None or detector in allowed.get("detector", (detector,)))
        and (mask is None or mask in allowed.get("mask", (mask,)))
    ]
    return [
        {
            "study": study.key,
            "year": study.year,
            "detector": detector,
            "mask": mask,
            **{name: study.number(name) for name in NUMBERS},
            "accuracy": next(iter(study.of("accuracy")), None),
            "studies": [study.key],
        }
        for detector, mask in sensors
    ]


def _axes(rows: Sequence[dict[str, Any]], facts: Facts) -> tuple[Axis, ...]:
    """Return the axes from left to right; on each, the better and the newer stand higher."""
    years = [row["year"] for row in rows if row["year"] is not None]
    first, last = min(years, default=2000), max(years, default=2001)
    marked = sorted({first, last, *(y for y in range(first, last) if y % 5 == 0)})
    spaced = [y for y in marked if y in (first, last) or (y - first > 1 and last - y > 1)]
    worst, best = _decades([row["accuracy_deg"] for row in rows if row["accuracy_deg"] is not None])
    return (
        Axis("year", "Year", ticks=tuple(Tick(year, str(year)) for year in spaced)),
        _named(rows, "detector", facts),
        _named(rows, "mask", facts),
        Axis(
            "fov_deg",
            "Field of view",
            ticks=tuple(Tick(n, f"{n}°") for n in (0, 90, 180, 270, 360)),
        ),
        Axis(
            "accuracy_deg",
            "Accuracy",
            ticks=tuple(Tick(10.0**n, f"{10.0**n:g}°") for n in range(worst, best - 1, -1)),
            logarithmic=True,
        ),
    )


def _decades(values: Sequence[float]) -> tuple[int, int]:
    """Return the powers of ten around the values, the greater first."""
    if not values:
        return 1, -4
    greatest, least = math.ceil(math.log10(max(values))), math.floor(math.log10(min(values)))
    return max(greatest, least + 1), least


def _named(rows: Sequence[dict[str, Any]], level: str, facts: Facts) -> Axis:
    """Return an axis of names: those that occur, the first of the taxonomy on top."""
    met = {row[level] for row in rows}
    values = [value for value in facts.taxonomy.values(level) if value in met]
    ticks = tuple(Tick(value, wording.shown(level, value)) for value in reversed(values))
    return Axis(level, wording.LEVELS[level], ticks=ticks, named=True)


def _title(row: dict[str, Any], facts: Facts) -> str:
    parts = [str(row["year"])] if row["year"] else []
    parts += [wording.shown(level, row[level]) for level in ("detector", "mask") if row[level]]
    for name, said in (("fov_deg", "field of view"), ("accuracy_deg", "accuracy")):
        known = row[name] is not None
        parts.append(f"{said} {row[name]:g}°" if known else f"{said} not known")
    if row["accuracy"] and row["accuracy_deg"] is None:
        parts[-1] = f"accuracy class {wording.spelt(facts.taxonomy, 'accuracy', row['accuracy'])}"
    return f"{row['study']}: {', '.join(parts)}"


def _text(studies: Sequence[Study], rows: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    known = {name: [s for s in studies if s.number(name) is not None] for name in NUMBERS}
    both = sum(study in known["fov_deg"] for study in known["accuracy_deg"])
    sensors = f"{wording.plural(len(rows), 'sensor', 'sensors')} of {wording.studies(len(studies))}"
    accuracies, fields = (len(known[name]) for name in ("accuracy_deg", "fov_deg"))
    numbers = f"the accuracy of {accuracies}, the field of view of {fields}, both of {both}"
    said = [f"{sensors}; known as numbers are {numbers} studies."]
    for name, words, best in (
        ("accuracy_deg", "Finest accuracy", min),
        ("fov_deg", "Widest field of view", max),
    ):
        if known[name]:
            first = best(known[name], key=lambda study: study.number(name) or 0.0)
            said.append(f"{words}: {first.number(name):g}°, {first.key}.")
    said.append("What is not known stands at the foot of its axis.")
    return tuple(said)
