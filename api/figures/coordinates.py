"""Parallel coordinates: year, detector, mask, field of view and accuracy of every sensor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.coordinates_svg import Axis, Polyline, Tick, draw_coordinates
from api.figures.figure import Entry, Figure
from api.schema.figures import SensorRow
from api.schema.table import columns_of
from registry.flows import LeftOut, Where, allowed_values, flows
from registry.studies import Facts, Study
from survey_data.reported import QUANTITIES, UNSPECIFIED, reported_accuracies

NAME = "coordinates"
TITLE = "Performance in parallel coordinates"
CAPTION = (
    "Each line is the sensor of a study: year, detector, mask, field of view and stated accuracy, "
    "as an RMS error. Dashed: the accuracy is of unspecified kind, drawn as printed."
)
NUMBERS = ("fov_deg", "accuracy_rms_deg")
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
            is_dashed=row["accuracy_kind"] == UNSPECIFIED,
        )
        for at, row in enumerate(rows)
    ]
    classes = [name for name in _COLOURS if any(row["accuracy"] == name for row in rows)]
    entries = [
        Entry(_COLOURS[name], wording.value_name(facts.taxonomy, "accuracy", name))
        if name
        else Entry(_COLOURS[None], "class of accuracy not known")
        for name in sorted(classes, key=lambda name: (name is None, list(_COLOURS).index(name)))
    ]
    left_out = tuple(
        LeftOut(name, tuple(study.key for study in studies if _number(study, name) is None))
        for name in NUMBERS
        if any(_number(study, name) is None for study in studies)
    )
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(studies, rows),
        studies=len(studies),
        left_out=left_out,
        columns=columns_of(SensorRow),
        rows=tuple(rows),
        draw=lambda width: draw_coordinates(axes, lines, entries, width),
    )


def _number(study: Study, name: str) -> float | None:
    """Return what a study states as an axis shows it: an accuracy as the RMS of its kind."""
    if name == "fov_deg":
        return study.number(name)
    accuracy = study.report("accuracy")
    return None if accuracy is None else accuracy.rms_deg


def _report(study: Study) -> dict[str, Any]:
    """Return accuracy and precision as printed, each with its kind; None is unknown."""
    found = {quantity: study.report(quantity) for quantity in QUANTITIES}
    return {
        name: value
        for quantity, one in found.items()
        for name, value in (
            (f"{quantity}_deg", None if one is None else one.value_deg),
            (f"{quantity}_kind", None if one is None else one.statistic.kind),
        )
    }


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
            **{name: _number(study, name) for name in NUMBERS},
            **_report(study),
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
    known = [row["accuracy_rms_deg"] for row in rows if row["accuracy_rms_deg"] is not None]
    worst, best = _decades(known)
    return (
        Axis("year", "Year", ticks=tuple(Tick(year, str(year)) for year in spaced)),
        _name_of(rows, "detector", facts),
        _name_of(rows, "mask", facts),
        Axis(
            "fov_deg",
            "Field of view",
            ticks=tuple(Tick(n, f"{n}°") for n in (0, 90, 180, 270, 360)),
        ),
        Axis(
            "accuracy_rms_deg",
            "RMS error",
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


def _name_of(rows: Sequence[dict[str, Any]], level: str, facts: Facts) -> Axis:
    """Return an axis of names: those that occur, the first of the taxonomy on top."""
    met = {row[level] for row in rows}
    values = [value for value in facts.taxonomy.values(level) if value in met]
    ticks = tuple(Tick(value, wording.display_name(level, value)) for value in reversed(values))
    return Axis(level, wording.LEVELS[level], ticks=ticks, named=True)


def _title(row: dict[str, Any], facts: Facts) -> str:
    parts = [str(row["year"])] if row["year"] else []
    parts += [
        wording.display_name(level, row[level]) for level in ("detector", "mask") if row[level]
    ]
    fov = row["fov_deg"]
    parts.append("field of view not known" if fov is None else f"field of view {fov:g}°")
    figures = [
        reported_accuracies(quantity, row[f"{quantity}_deg"], row[f"{quantity}_kind"])
        for quantity in QUANTITIES
        if row[f"{quantity}_deg"] is not None
    ]
    parts += [f"{figure.label} {figure.value_deg:g}°" for figure in figures]
    if row["accuracy_deg"] is None and row["accuracy"]:
        name = wording.value_label(facts.taxonomy, "accuracy", row["accuracy"])
        parts.append(f"accuracy class {name}")
    elif not figures:
        parts.append("accuracy not known")
    return f"{row['study']}: {', '.join(parts)}"


def _text(studies: Sequence[Study], rows: Sequence[dict[str, Any]]) -> tuple[str, ...]:
    known = {name: [s for s in studies if _number(s, name) is not None] for name in NUMBERS}
    both = sum(study in known["fov_deg"] for study in known["accuracy_rms_deg"])
    sensors = f"{wording.plural(len(rows), 'sensor', 'sensors')} of {wording.studies(len(studies))}"
    accuracies, fields = (len(known[name]) for name in reversed(NUMBERS))
    numbers = f"the accuracy of {accuracies}, the field of view of {fields}, both of {both}"
    said = [f"{sensors}; known as numbers are {numbers} studies."]
    reports = [(study, one) for study in studies if (one := study.report("accuracy")) is not None]
    stated = [(s, one) for s, one in reports if one.statistic.kind != UNSPECIFIED]
    if stated:
        study, one = min(stated, key=lambda pair: pair[1].rms_deg)
        said.append(
            f"Finest accuracy whose kind is stated: {one.rms_deg:.3g}° RMS ({one.label} "
            f"{one.value_deg:g}°), {study.key}; {len(reports) - len(stated)} have none stated."
        )
    if known["fov_deg"]:
        widest = max(known["fov_deg"], key=lambda study: study.number("fov_deg") or 0.0)
        said.append(f"Widest field of view: {widest.number('fov_deg'):g}°, {widest.key}.")
    said.append("What is not known stands at the foot of its axis.")
    return tuple(said)
