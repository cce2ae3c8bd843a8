"""The data of a data set under one condition, generated once and kept while a worker needs them.

`rendered` is the stage that makes data, `found_features` the one that makes features; what keeps
them between stages changes no number.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from benchmark.canonical import digest
from benchmark.contract import SPLITS, Cell
from benchmark.datasets.controls import board_facts
from benchmark.datasets.corrected import corrections
from benchmark.datasets.pins import Pin
from benchmark.datasets.samples import HEAD, head_hash, samples_hash
from benchmark.metrics.separation import store
from benchmark.processes import release_free_memory
from benchmark.running.kept_stages import DATA, TRUTH, KeptStages
from benchmark.running.readings import correct_readings
from benchmark.running.stages import ConditionData, RenderedData
from benchmark.simulator.light.memory import LIMIT_BYTES, memory

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples
    from benchmark.metrics.bounds import Bound

#: Datasets under one condition kept per process: the plan hands out a dataset's tasks in a row.
_KEPT = 2
#: Bytes of kept observations from which on only one dataset is: a worker stays below 1.2 GB.
_KEPT_BYTES = 128 * 2**20
#: Bytes of light that frames are generated beside, and of frames beyond which it gives way to them.
_LIGHT_BYTES, _FRAME_BYTES = LIMIT_BYTES * 5 // 8, 192 * 2**20


_Place = tuple[str, str, int, str]  # dataset, condition, unit, digest of the parameters
_kept: OrderedDict[_Place, ConditionData] = OrderedDict()
#: Which test samples can be observed, of data whose other units asked; a unit is asked of each.
_observable: dict[_Place, NDArray[np.bool_]] = {}


def generate(
    preset: Preset,
    condition: str,
    unit: int = 0,
    *,
    all_observable: bool = False,
    kept: KeptStages | None = None,
) -> ConditionData:
    """Return the data of a data set under one condition, as a unit of its sensor sees them.

    `all_observable`: every test sample is known to be observable, so that another unit than the
    standard one needs no bound. `kept` is where data may be kept between processes.
    """
    place = _place_of(preset, condition, unit)
    if place not in _kept:
        _make_room(preset.name)
        made = _rendered_or_kept(preset, condition, unit, all_observable, kept)
        _kept[place] = correct_readings(made, preset)
    _kept.move_to_end(place)
    return _kept[place]


def truth(
    preset: Preset,
    condition: str,
    unit: int = 0,
    *,
    all_observable: bool = False,
    kept: KeptStages | None = None,
) -> ConditionData:
    """Return as `generate`, but without observations where the rest is kept."""
    if kept is not None and _place_of(preset, condition, unit) not in _kept:
        found: ConditionData | None = kept.get(TRUTH, _cell(preset, condition, unit))
        if found is not None:
            return replace(found, preset=preset)
    return generate(preset, condition, unit, all_observable=all_observable, kept=kept)


def render(preset: Preset, condition: str, unit: int, *, all_observable: bool) -> RenderedData:
    """Generate data from nothing. Parameters as `generate`."""
    # the conditions of a dataset see the same Suns, its units look up the same tables
    memory.limit_bytes = LIMIT_BYTES
    memory.cache_for((preset.name, unit), preset.name)
    seen_by = preset.for_unit(unit) if unit else preset
    # while no frames take memory; its bound, which scores need, tells what is observable
    bound = None if unit else preset.bound(condition, "test")
    memory.limit_bytes = _LIGHT_BYTES
    wanted = SPLITS if not unit else ("calibration", "test")
    splits: dict[str, Samples] = {}
    for split in wanted:
        splits[split] = seen_by.generate(condition, split)
        _leave_room(splits, (preset.name, unit), preset.name)
    if bound is None:
        data = _of_another_unit(preset, condition, splits, all_observable)
    else:
        data = _of_unit_zero(preset, condition, splits, bound)
    return RenderedData(data, corrections(seen_by, condition))


def _leave_room(splits: Mapping[str, Samples], *owner: Hashable) -> None:
    """Keep less light where frames take much memory themselves."""
    beyond = _bytes_of(splits.values()) - _FRAME_BYTES
    if beyond <= 0:
        return
    memory.limit_bytes = max(_LIGHT_BYTES - beyond, LIMIT_BYTES // 16)
    if memory.kept_bytes > memory.limit_bytes:
        memory.forget()
        memory.cache_for(*owner)
    release_free_memory()


def _rendered_or_kept(
    preset: Preset, condition: str, unit: int, all_observable: bool, kept: KeptStages | None
) -> RenderedData:
    if kept is None:
        return render(preset, condition, unit, all_observable=all_observable)
    cell = _cell(preset, condition, unit)
    found: RenderedData | None = kept.get(DATA, cell)
    if found is not None:
        return found
    if (
        unit
        and not all_observable
        and (place := _place_of(preset, condition, 0)) not in _observable
    ):
        standard: ConditionData | None = kept.get(TRUTH, _cell(preset, condition, 0))
        if standard is not None:
            _observable[place] = standard.observable
    made = render(preset, condition, unit, all_observable=all_observable)
    # extractors and models need the room
    memory.release_mapped()
    release_free_memory()
    # a preset is the caller's own: it is not kept, but taken from who asks
    bare = replace(made.data, preset=cast("Preset", None))
    kept.put(DATA, cell, replace(made, data=bare))
    unseen = {split: _unseen(samples) for split, samples in bare.splits.items()}
    kept.put(TRUTH, cell, replace(bare, splits=unseen))
    return made


def _cell(preset: Preset, condition: str, unit: int) -> Cell:
    return Cell(preset.name, condition, "", "", unit)


def _unseen(samples: Samples) -> Samples:
    """Return samples without observations."""
    nothing = np.empty((len(samples.sun), 0))
    return cast("Samples", replace(cast("Any", samples), observations=nothing))


def forget() -> None:
    """Let go of everything that is kept."""
    _kept.clear()
    _observable.clear()


def generated_pins(preset: Preset, condition: str) -> tuple[Pin, ...]:
    """Pins of a dataset's splits as this machine generates them."""
    return generate(preset, condition).pins


def _place_of(preset: Preset, condition: str, unit: int) -> _Place:
    """Name data by what they depend on; known without a digest for what is kept of this object."""
    for place, data in _kept.items():
        if data.preset is preset and place[:3] == (preset.name, condition, unit):
            return place
    return preset.name, condition, unit, digest(preset.parameters(condition))


def _of_unit_zero(
    preset: Preset, condition: str, splits: dict[str, Samples], bound: Bound
) -> ConditionData:
    angle, observable = np.asarray(bound.angle_deg), np.asarray(bound.observable, dtype=np.bool_)
    pins = tuple(_pin(preset, condition, split, splits[split], bound) for split in SPLITS)
    unit = bound.unit_angle_deg
    unit_angle = None if unit is None else np.asarray(unit)
    return ConditionData(preset, splits, angle, unit_angle, observable, pins, bound)


def _of_another_unit(
    preset: Preset, condition: str, splits: dict[str, Samples], all_observable: bool
) -> ConditionData:
    """Without bounds; what is observable is taken from the standard unit's."""
    if all_observable:
        everything = np.ones(len(splits["test"].sun), dtype=np.bool_)
        return ConditionData(preset, splits, None, None, everything, ())
    place = _place_of(preset, condition, 0)
    if place not in _observable:
        bound = preset.bound(condition, "test")
        _observable[place] = np.asarray(bound.observable, dtype=np.bool_)
    return ConditionData(preset, splits, None, None, _observable[place], ())


def _pin(preset: Preset, condition: str, split: str, samples: Samples, bound: Bound) -> Pin:
    pins: dict[str, Any] = {}
    if split == "test":
        pins = {
            "observable": int(np.asarray(bound.observable, dtype=np.bool_).sum()),
            "bound_deg": rms_bound(bound),
            "head_bound_deg": rms_bound(bound, HEAD),
            **board_facts(preset, condition, np.asarray(samples.sun), bound),
        }
    return Pin(
        preset.name,
        condition,
        split,
        preset.version,
        len(samples.sun),
        samples_hash(samples),
        head_hash(samples),
        **pins,
    )


def rms_bound(bound: Bound, first: int | None = None) -> float | None:
    """Return the bound over the (first) observable samples as pins keep it; None for none."""
    seen = np.asarray(bound.observable, dtype=np.bool_)[:first]
    angle = np.asarray(bound.angle_deg)[:first][seen]
    return store(float(np.sqrt(np.mean(angle**2)))) if len(angle) else None


def _make_room(dataset: str) -> None:
    """Let go of other data sets and of what was used longest ago, before more is generated."""
    for place in [place for place in _kept if place[0] != dataset]:
        del _kept[place]
    while _kept and (len(_kept) >= _KEPT or _kept_bytes() > _KEPT_BYTES):
        _kept.popitem(last=False)
    release_free_memory()


def _kept_bytes() -> int:
    return sum(_bytes_of(data.splits.values()) for data in _kept.values())


def _bytes_of(splits: Iterable[Samples]) -> int:
    return sum(np.asarray(split.observations).nbytes for split in splits)
