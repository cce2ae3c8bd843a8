"""An answer in two levels as text: architectures, then calibrations of each."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from api.cli.table_output import prose, table
from registry.contradiction import calibration_name, labels, pipeline_name

ORDERS = {
    "advice": "ranked by advice of the survey and use in studies, then by error",
    "support": "ranked by number of studies",
    "measured": "ranked by measured error",
}
_NARROW = 30
_LABEL = 13  # columns before the text of a labelled paragraph
_HEADINGS = ("", "calibration", "survey labels", "advised", "studies", "measured, deg")
_INDENT = "    "


def text(document: Mapping[str, Any], width: int) -> str:
    """Return the architectures of an answer with their three kinds of evidence, as lines."""
    return "\n".join(itertools.chain(_head(document, width), _body(document, width))) + "\n"


def explanation(blocked: Mapping[str, Any], width: int) -> str:
    """Return which requirement excludes all architectures, and changes that would help."""
    lines = prose(
        f"no architecture meets the requirements: {blocked['constraint']}: {blocked['detail']}",
        width,
        "  ",
    )
    for relaxation in blocked["relaxations"]:
        found = _many(relaxation["architectures"], "architecture")
        lines += prose(f"{relaxation['words']}: {found}", width, "    ", "  - ")
    return "\n".join(lines)


def _head(document: Mapping[str, Any], width: int) -> Iterator[str]:
    shown, count = len(document["architectures"]), document["count"]
    first = "" if shown == count else f"first {shown} of "
    yield from prose(
        f"{first}{_many(count, 'architecture')}, {_many(document['designs'], 'calibration')} in "
        f"all; {ORDERS[document['sort']]}",
        width,
    )
    for sentence in document["contradictions"]:
        yield from _paragraph("contrary", sentence, width)
    if document["regret"] is not None:
        yield from _paragraph("accuracy", document["regret"]["sentence"], width)
    if document["untimed"]:
        said = f"{_many(document['untimed'], 'pipeline')}, excluded by the latency limit"
        yield from _paragraph("not timed", f"{said}; run `sunatlas leaderboard times`", width)
    for hazard, pairs in document["untried"].items():
        if pairs:
            named = ", ".join(f"{pair['detector']} + {pair['mask']}" for pair in pairs)
            yield from _paragraph("not tested", f"{hazard}: no data set of {named}", width)


def _body(document: Mapping[str, Any], width: int) -> Iterator[str]:
    for architecture in document["architectures"]:
        yield ""
        pareto = (
            " (Pareto: no other has more studies and a lower error)"
            if architecture["pareto"]
            else ""
        )
        name = f"{architecture['detector']} + {architecture['mask']}"
        yield from prose(f"{name}{pareto}", width, _INDENT, f"{architecture['rank']:<3} ")
        yield from _architecture(architecture, width)


def _architecture(architecture: Mapping[str, Any], width: int) -> Iterator[str]:
    tasks = [
        f"{task['task']}{' (advised)' if task['advised'] else ''} {task['studies']}"
        for task in architecture["tasks"]
    ]
    if tasks:
        yield from _paragraph("tasks", ", ".join(tasks), width)
    yield from _paragraph("advised", _advise(architecture["advice"]), width)
    yield from _paragraph("used", _propose(architecture["studies"]), width)
    yield from _paragraph("measured", _measure(architecture["best"]), width)
    for measure in architecture["measures"]:
        if measure["task"] != "Accuracy":
            yield from _paragraph("by task", measure["words"], width)
    finer = (architecture["best"]["measured"] or {}).get("finer")
    if finer is not None:
        yield from _paragraph("or", _finer(finer), width)
    if architecture["contradiction"]:
        yield from _paragraph("contrary", architecture["contradiction"], width)
    calibrations = architecture["calibrations"]
    rows = [_calibration(calibration, architecture["advice"]) for calibration in calibrations]
    yield table(rows, _HEADINGS, width, _INDENT, rule=False)
    rest = architecture["count"] - len(calibrations)
    if rest:
        yield f"{_INDENT}... and {rest} more"


def _advise(advice: Sequence[Mapping[str, Any]]) -> str:
    """Return the advice of the survey for an architecture, with its section."""
    if not advice:
        return "not for these requirements"
    found: dict[str, list[str]] = {}
    for one in advice:
        kind = "" if one["requirement"] == "task" else "class "
        how = ", ".join(filter(None, (one["model_category"], one["extractor"])))
        found.setdefault(f"{kind}{one['value']}", []).append(how)
    ways = {what: " or ".join(filter(None, how)) for what, how in found.items()}
    said = "; ".join(f"{what}: {how}" if how else what for what, how in ways.items())
    return f"{said} (in {', '.join(dict.fromkeys(one['section_name'] for one in advice))})"


def _propose(studies: Sequence[str]) -> str:
    if not studies:
        return "by no study that meets the requirements"
    return f"by {_many(len(studies), 'study', 'studies')}: {', '.join(studies)}"


def _measure(best: Mapping[str, Any]) -> str:
    """Return the error of the best calibration of an architecture, with its data set."""
    measured = best["measured"]
    if measured is None:
        return "no"
    nominal, units = measured["nominal"], measured["units"]
    parts = [f"{_over(measured, ' deg')} ({measured['dataset']}, {measured['condition']})"]
    if measured["error_deg"] != nominal["rms_deg"]:
        parts.append(f"nominal {nominal['rms_deg']:.3g} deg")
    if nominal["over_bound"] is not None:
        ratio = nominal["over_bound"]
        times = f"{ratio:.0f}" if ratio >= 1000 else f"{ratio:.3g}"
        parts.append(f"{times} times the bound {nominal['bound_deg']:.3g} deg")
    if measured["availability"] is not None:
        parts.append(f"availability {100 * measured['availability']:.4g} %")
    if units is not None and units["within_limit"] is not None:
        parts.append(f"{units['within_limit']} of {units['of']} units meet it")
        parts.append(f"own error {measured['own_deg']:.3g} deg")
    if measured["needs"]:
        parts.append(f"also needs {', '.join(measured['needs'])}")
    if units is not None and units["count"] > 1:
        spread = f"{units['least_deg']:.3g} to {units['largest_deg']:.3g} deg"
        parts.append(f"{units['count']} units {spread}")
    return f"{_way(best)}: {'; '.join(parts)}"


def _finer(finer: Mapping[str, Any]) -> str:
    """Return the pipeline with a lower error at lower availability."""
    return (
        f"lower error at {100 * finer['availability']:.4g} % availability: "
        f"{pipeline_name(finer['extractor'], finer['model'])}, {finer['error_deg']:.3g} deg "
        f"({finer['dataset']})"
    )


def _calibration(
    calibration: Mapping[str, Any], advice: Sequence[Mapping[str, Any]]
) -> dict[str, str]:
    for_what = {one["id"] for one in advice}.intersection(calibration["advised"])
    measured = calibration["measured"]
    where = "no" if measured is None else _over(measured, "")
    if measured is not None and measured["condition"] != measured["nominal"]["condition"]:
        where = f"{where}, {measured['condition']}"
    cells = (
        str(calibration["rank"]),
        _way(calibration),
        labels(calibration["extractor"], _stages(calibration)),
        "yes" if for_what else "no",
        str(len(calibration["studies"])) if calibration["studies"] else "none",
        where,
    )
    return dict(zip(_HEADINGS, cells, strict=True))


def _over(measured: Mapping[str, Any], unit: str) -> str:
    """Return the error that a pipeline is ranked by, with its field of view."""
    if measured["error_deg"] is None:
        return "availability below 95 %"
    field = measured["field_deg"]
    over = "all directions" if field in (None, 360.0) else f"{field:g}{unit}"
    return f"{measured['error_deg']:.3g}{unit} over {over}"


def _way(calibration: Mapping[str, Any]) -> str:
    measured = calibration["measured"]
    name = None if measured is None else (measured["extractor"], measured["model"])
    return calibration_name(calibration["extractor"], _stages(calibration), name)


def _stages(calibration: Mapping[str, Any]) -> tuple[str, ...]:
    return (*calibration["compensations"], calibration["model"])


def _many(number: int, one: str, several: str | None = None) -> str:
    return f"{number} {one if number == 1 else several or one + 's'}"


def _paragraph(label: str, words: str, width: int) -> list[str]:
    left = f"{_INDENT}{label}".ljust(_LABEL + 2)
    if width < 2 * _NARROW:  # a column of labels leaves too little beside it
        return prose(f"{label}: {words}", width, f"{_INDENT}  ", _INDENT)
    return prose(words, width, " " * len(left), left)
