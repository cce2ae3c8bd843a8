"""Do the files of a record agree with each other, and with the data sets? In a second, unmeasured.

A bound stands in the pins and again in every score of a pipeline that answers all samples; a ratio
stands beside what it is a ratio of; sizes and versions are known of the data sets. A number that
was changed in one of these places contradicts another.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin, Place, bounds_agree
from benchmark.plan.parts import Parts
from benchmark.results.csv_tables import Row
from benchmark.results.store import Store

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

#: What two roundings to five digits and that of their quotient can add up to.
_ROUNDED = 1.6e-4

#: (file, cell, what stands there, what should)
Told = tuple[str, str, str, str]


def contradictions(store: Store, parts: Parts) -> Iterator[Told]:
    """Yield what cannot be so: file, cell, what stands there and what should, in their order."""
    pins, scores = store.pins(), store.scores()
    yield from _of_pins(store.pins_path.name, pins, parts)
    yield from _of_bounds(store.pins_path.name, pins, scores)
    for cell, row in scores.items():
        for column, stands, should in _of_ratios(row):
            yield f"scores/{cell.dataset}.csv", f"{cell}/{column}", stands, should


def _of_pins(file: str, pins: Mapping[Place, Pin], parts: Parts) -> Iterator[Told]:
    sizes = {name: _sizes(preset) for name, preset in parts.presets.items()}
    for place, pin in pins.items():
        cell = "/".join(place)
        preset = parts.presets.get(pin.dataset)
        if preset is None:  # named elsewhere: it is not planned
            continue
        if pin.version != preset.version:
            yield file, f"{cell}/version", str(pin.version), str(preset.version)
        size = sizes[pin.dataset].get(pin.split)
        if size is not None and pin.n != size:
            yield file, f"{cell}/n", str(pin.n), str(size)
        tests = pins.get((pin.dataset, pin.condition, "test"))
        if size is None and pin.split == "repeat" and tests is not None:
            repeated = len(preset.repeats.pose_indices(tests.n)) * preset.repeats.passes
            if pin.n != repeated:
                yield file, f"{cell}/n", str(pin.n), f"{repeated}, as of {tests.n} test samples"


def _sizes(preset: Preset) -> dict[str, int]:
    """Return how many samples each split has; nothing for a preset whose directions say nothing."""
    directions: Any = getattr(preset, "directions", None)
    if directions is None:
        return {}
    sizes = {split: int(about["samples"]) for split, about in directions.card().items()}
    return {
        **sizes,
        "repeat": len(preset.repeats.pose_indices(sizes["test"])) * preset.repeats.passes,
    }


def _of_bounds(file: str, pins: Mapping[Place, Pin], scores: Mapping[Cell, Row]) -> Iterator[Told]:
    """Compare pinned bounds with those of the scores over the same samples."""
    over_all: dict[Place, dict[Cell, float]] = {}
    for cell, row in scores.items():
        place = (cell.dataset, cell.condition, "test")
        answers_all = row["status"] == "ok" and row["availability"] == 1.0 and cell.unit == 0
        if answers_all and row["bound_deg"] is not None and place in pins:
            over_all.setdefault(place, {})[cell] = row["bound_deg"]
    for place, bounds in over_all.items():
        pinned = pins[place].bound_deg
        unlike = {cell: bound for cell, bound in bounds.items() if not bounds_agree(pinned, bound)}
        stands = "absent" if pinned is None else f"{pinned:g}"
        first = next(iter(bounds.values()))
        if len(unlike) == len(bounds) and all(
            bounds_agree(first, bound) for bound in bounds.values()
        ):
            yield file, f"{'/'.join(place)}/bound_deg", stands, f"{first:g}, as the scores have it"
            continue
        for cell, bound in unlike.items():
            named = f"scores/{cell.dataset}.csv", f"{cell}/bound_deg"
            yield *named, f"{bound:g}", f"{stands}, as pinned"


def _of_ratios(row: Row) -> Iterator[tuple[str, str, str]]:
    for ratio, bound in (("over_bound", "bound_deg"), ("over_bound_unit", "bound_unit_deg")):
        over, of, by = row[ratio], row["rms_deg"], row[bound]
        complete = over is not None and of is not None and by
        if complete and not math.isclose(over, of / by, rel_tol=_ROUNDED):
            yield ratio, f"{over:g}", f"{of / by:.5g}, the ratio of rms_deg and {bound}"
