"""Parallel coordinates: year, detector, mask, field of view and accuracy of every sensor."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure
from api.figures.specification import (
    AXIS,
    CATEGORIES,
    HOVER,
    UNKNOWN,
    Plotly,
    axis,
    mark,
    specification,
)
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
_COLOURS: Mapping[str | None, str] = {
    None: UNKNOWN,
    **dict(zip(("CSS", "FSS", "VFSS", "UFSS"), (CATEGORIES[k] for k in (3, 1, 2, 0)), strict=True)),
}
"""Accuracy class -> colour, what is drawn first first."""
_FOOT = 0.12  # of an axis of numbers, below the lowest: what is not known
_SLOT = 0.7  # share of a name's slot over which its lines are spread


@dataclass(frozen=True)
class _Axis:
    """An axis: values and labels of its ticks, from the lowest place to the highest."""

    name: str
    title: str
    ticks: Mapping[float | str, str]
    named: bool = False
    logarithmic: bool = False

    def place(self, value: float | str | None, shift: float = 0.0) -> float:
        """Return the place of a value, 0 to 1; of a name, shifted by a share of its slot."""
        if self.named:
            at = 0 if value is None else list(self.ticks).index(value) + 1
            return (at + 0.5 + shift) / (len(self.ticks) + 1)
        if value is None or not self.ticks:
            return 0.0
        ends = [list(self.ticks)[end] for end in (0, -1)]
        scaled = [math.log10(float(v)) if self.logarithmic else float(v) for v in (*ends, value)]
        low, high, shown = scaled
        share = (shown - low) / (high - low) if high != low else 0.5
        return _FOOT + (1 - _FOOT) * min(max(share, 0.0), 1.0)


def coordinates_figure(facts: Facts, addresses: Addresses, where: Where) -> Figure:
    """Return a line for every sensor of the studies that meet `where`."""
    found = flows(("detector", "mask"), where, facts=facts)
    studies = [facts.studies[key] for key in found.studies]
    rows = [row for study in studies for row in _sensors(study, facts, where)]
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
        columns=columns_of(SensorRow),
        rows=tuple(rows),
        plotly=_plotly(rows, facts, addresses),
        studies=len(studies),
        left_out=left_out,
    )


def _plotly(rows: Sequence[dict[str, Any]], facts: Facts, addresses: Addresses) -> Plotly:
    """Return a line a sensor over upright axes, those of a class as one trace with gaps."""
    axes = _axes(rows, facts)
    traces: dict[tuple[str | None, bool], dict[str, list[Any]]] = {}
    shifts = {one.name: _spread(rows, one.name) for one in axes if one.named}
    for at, row in enumerate(rows):
        of = (row["accuracy"], row["accuracy_kind"] == UNSPECIFIED)
        trace = traces.setdefault(of, {"x": [], "y": [], "customdata": []})
        href = addresses.of([row["study"]], {}, at)
        for x, one in enumerate(axes):
            value = row[one.name]
            trace["x"].append(x)
            trace["y"].append(one.place(value, shifts[one.name][at] if one.named else 0.0))
            trace["customdata"].append(mark(_title(row, facts), href, value=value))
        for gap in trace.values():
            gap.append(None)
    data = [
        {
            "type": "scatter",
            "mode": "lines+markers",
            "name": name or "class not known",
            "legendgroup": str(name),
            "showlegend": not dashed or (name, False) not in traces,
            **traces[name, dashed],
            "line": {"color": tone, "width": 1.4, "dash": "dash" if dashed else "solid"},
            "marker": {"color": tone, "size": 4},
            "opacity": 0.75 if name else 0.4,
            "hovertemplate": HOVER,
        }
        for name, tone in _COLOURS.items()
        for dashed in (False, True)
        if (name, dashed) in traces
    ]
    unknown = [one for one in axes if any(row[one.name] is None for row in rows)]
    ticks = [
        _note(at, one.place(value), label, xanchor="right", xshift=-6)
        for at, one in enumerate(axes)
        for value, label in [*one.ticks.items(), *[(None, "not known")] * (one in unknown)]
    ]
    heads = [_note(at, 1.0, one.title, yshift=16) for at, one in enumerate(axes)]
    return specification(
        data,
        height=560,
        narrowest=760,
        margin={"l": 8, "r": 8, "t": 60, "b": 8},
        xaxis={**axis(range=[-0.6, len(axes) - 0.8]), "visible": False},
        yaxis={**axis(range=[-0.03, 1.06]), "visible": False},
        shapes=[
            {"type": "line", **dict.fromkeys(("x0", "x1"), at), "y0": 0, "y1": 1, "layer": "below",
             "line": {"color": AXIS, "width": 1}}
            for at in range(len(axes))
        ],
        annotations=[*ticks, *heads],
    )  # fmt: skip


def _note(x: float, y: float, text: str, **more: Any) -> dict[str, Any]:
    return {"x": x, "y": y, "xref": "x", "yref": "y", "text": text, "showarrow": False, **more}


def _spread(rows: Sequence[dict[str, Any]], name: str) -> list[float]:
    """Return for each row where in its value's slot its line runs, so that lines part."""
    alike = [[at for at, other in enumerate(rows) if other[name] == row[name]] for row in rows]
    return [_SLOT * ((of.index(at) + 0.5) / len(of) - 0.5) for at, of in enumerate(alike)]


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


def _axes(rows: Sequence[dict[str, Any]], facts: Facts) -> tuple[_Axis, ...]:
    """Return the axes from left to right; on each, the better and the newer stand higher."""
    years = [row["year"] for row in rows if row["year"] is not None]
    first, last = min(years, default=2000), max(years, default=2001)
    marked = sorted({first, last, *(y for y in range(first, last) if y % 5 == 0)})
    spaced = [y for y in marked if y in (first, last) or (y - first > 1 and last - y > 1)]
    known = [row["accuracy_rms_deg"] for row in rows if row["accuracy_rms_deg"] is not None]
    worst, best = _decades(known)
    return (
        _Axis("year", "Year", {year: str(year) for year in spaced}),
        _name_of(rows, "detector", facts),
        _name_of(rows, "mask", facts),
        _Axis("fov_deg", "Field of view", {float(n): f"{n}°" for n in (0, 90, 180, 270, 360)}),
        _Axis(
            "accuracy_rms_deg",
            "RMS error",
            {10.0**n: f"{10.0**n:g}°" for n in range(worst, best - 1, -1)},
            logarithmic=True,
        ),
    )


def _decades(values: Sequence[float]) -> tuple[int, int]:
    """Return the powers of ten around the values, the greater first."""
    if not values:
        return 1, -4
    greatest, least = math.ceil(math.log10(max(values))), math.floor(math.log10(min(values)))
    return max(greatest, least + 1), least


def _name_of(rows: Sequence[dict[str, Any]], level: str, facts: Facts) -> _Axis:
    """Return an axis of names: those that occur, the first of the taxonomy on top."""
    met = {row[level] for row in rows}
    values = [value for value in facts.taxonomy.values(level) if value in met]
    ticks: dict[float | str, str] = {
        value: wording.display_name(level, value) for value in reversed(values)
    }
    return _Axis(level, wording.LEVELS[level], ticks, named=True)


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
    sensors = f"{wording.plural(len(rows), 'sensor')} of {wording.studies(len(studies))}"
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
