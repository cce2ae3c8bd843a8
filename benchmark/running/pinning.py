"""Pinning data: the hash and bound of every dataset, condition and split; and guarding the pins.

A run pins what it measures; here is pinned what remains. Data or bounds that differ from their
pin under the same version of their dataset are an error that names the dataset: a change of code
that moves them has to say so.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import closing, nullcontext
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

from algorithms.threads import one_thread
from benchmark.contract import SPLITS, UnknownNameError
from benchmark.datasets.pins import Pin, Place, bounds_agree
from benchmark.datasets.samples import HEAD, head_hash
from benchmark.plan.parts import Parts, installed_parts
from benchmark.progress import ProgressCallback, terminal_progress
from benchmark.results.components import Components, current
from benchmark.results.record import Record, open_record
from benchmark.results.store import Store
from benchmark.running.condition_data import generated_pins, rms_bound
from benchmark.running.fitting import reason_of
from benchmark.running.workers import as_completed
from benchmark.simulator.light.memory import memory

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset

Condition = tuple[str, str]  # (dataset, condition)


class UnversionedChangeError(ValueError):
    """Data or bounds have changed, and the versions of their datasets have not.

    `changes` has a line for each split that changed, by dataset.
    """

    def __init__(self, changes: Mapping[str, list[str]]) -> None:
        self.changes = {name: list(lines) for name, lines in sorted(changes.items())}
        named = "; ".join(f"{name} ({lines[0]})" for name, lines in self.changes.items())
        super().__init__(
            f"data of {len(self.changes)} data sets changed while their versions did not: {named}. "
            "Raise `version` in their presets if the change is meant"
        )


@dataclass(frozen=True)
class PinResult:
    """What was pinned.

    `kept`, `renewed`: conditions that were pinned for the code as it is, and that are now;
    `warnings` name data that cannot be generated.
    """

    store: Path
    kept: int
    renewed: int
    warnings: tuple[str, ...]
    seconds: float


def places(parts: Parts | None = None) -> set[Place]:
    """Return everything there is to pin: (dataset, condition, split)."""
    return {
        (preset.name, condition, split)
        for preset in (parts or installed_parts()).presets.values()
        for condition in preset.conditions
        for split in SPLITS
    }


def unversioned_changes(pinned: Mapping[Place, Pin], made: Iterable[Pin]) -> dict[str, list[str]]:
    """Return what differs from its pin though the dataset's version is the pin's, by dataset."""
    found: dict[str, list[str]] = {}
    for pin in made:
        known = pinned.get(pin.place)
        if known is not None and known.version == pin.version and (said := known.difference(pin)):
            found.setdefault(pin.dataset, []).append(f"{pin.condition} {pin.split}: {said}")
    return found


def require_versions(pinned: Mapping[Place, Pin], made: Iterable[Pin]) -> None:
    """Raise UnversionedChangeError where data differ from their pin under the same version."""
    changes = unversioned_changes(pinned, made)
    if changes:
        raise UnversionedChangeError(changes)


def changed_heads(
    pinned: Mapping[Place, Pin], presets: Iterable[Preset], workers: int = 1
) -> dict[str, list[str]]:
    """Generate the first samples of every split and say what is not as pinned, by dataset.

    A check in seconds: of each split `benchmark.results.digests.HEAD` samples, and their bound.
    Presets of another version than their pins are not looked at.
    """
    wanted = []
    for preset in presets:
        places = product((preset.name,), preset.conditions, SPLITS)
        pins = [pinned[place] for place in places if place in pinned]
        wanted.append((preset, [pin for pin in pins if pin.version == preset.version]))
    with closing(as_completed(_changed_heads, wanted, min(workers, len(wanted) or 1))) as found:
        return dict(sorted((name, lines) for name, lines in found if lines))


def presets_of_other_code(store: Store, parts: Parts, components: Components) -> list[Preset]:
    """List the datasets whose code or parameters are not those that the store was written with."""
    stored = store.components()
    alike = stored.stages.get("data") == components.stages.get("data")
    return [
        preset
        for name, preset in parts.presets.items()
        if not alike
        or name not in stored.datasets
        or stored.digest("datasets", name) != components.digest("datasets", name)
    ]


def _changed_heads(wanted: tuple[Preset, list[Pin]]) -> tuple[str, list[str]]:
    """Return a dataset's name, and a line for each split whose first samples are not as pinned."""
    preset, pins = wanted
    memory.cache_for((preset.name, preset.unit), preset.name)
    try:
        with one_thread():
            said = {f"{pin.condition} {pin.split}": _changed_head(pin, preset) for pin in pins}
    finally:
        memory.forget()  # light of a few samples; tables stay
    return preset.name, [f"{place}: {change}" for place, change in said.items() if change]


def _changed_head(pin: Pin, preset: Preset) -> str:
    hashed = head_hash(preset.generate(pin.condition, pin.split, HEAD))
    if hashed != pin.head_hash:
        return f"head_hash {hashed}, pinned {pin.head_hash}"
    if pin.split != "test":
        return ""
    bound = rms_bound(preset.bound(pin.condition, pin.split, HEAD))
    if bounds_agree(pin.head_bound_deg, bound):
        return ""
    return f"head_bound_deg {bound}, pinned {pin.head_bound_deg}"


def pin_missing(
    record: Record,
    components: Components,
    parts: Parts,
    *,
    workers: int,
    progress: ProgressCallback | None = None,
    datasets: Collection[str] | None = None,
) -> PinResult:
    """Generate and pin what is not pinned for the code as it is.

    What is generated is on disk before the next is awaited. Data that changed without a new
    version are pinned all the same: it is for the caller to compare them with what was pinned
    before (`require_versions`).
    """
    started = time.perf_counter()
    every = conditions_of(parts, datasets)
    missing = [
        (preset, condition)
        for preset, condition in every
        if not all(
            record.is_pinned((preset.name, condition, split), components) for split in SPLITS
        )
    ]
    warnings: list[str] = []
    renewed = 0
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        report(0, len(missing), "")
        for done, (preset, condition, pins, reason) in enumerate(
            generate(missing, workers), start=1
        ):
            record.keep(components, pins=pins)
            renewed += bool(pins)
            if reason:
                warnings.append(f"{preset.name} {condition}: cannot be generated: {reason}")
            report(done, len(missing), f"{preset.name} {condition}")
    return PinResult(
        record.store.directory,
        len(every) - len(missing),
        renewed,
        tuple(warnings),
        time.perf_counter() - started,
    )


def update(
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    datasets: Collection[str] | None = None,
    parts: Parts | None = None,
) -> PinResult:
    """Pin what is not pinned for the code as it is, and write the store.

    Scores of datasets whose code has changed are dropped: they are of other data, or may be.
    Parameters as `pin_missing`. UnversionedChangeError where data changed while the dataset's
    version did not: nothing is written then. UnknownNameError for what is not installed,
    StoreLockedError when a runner writes to the store.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    known = parts or installed_parts()
    components = current(known)
    with open_record(store) as record:
        pinned = store.pins()
        done = pin_missing(
            record, components, known, workers=workers, progress=progress, datasets=datasets
        )
        require_versions(pinned, record.pins.values())
        named = {preset.name for preset, _ in conditions_of(known, datasets)}
        only = {name: facts for name, facts in components.datasets.items() if name in named}
        record.write(Components(components.stages, datasets=only))
    return done


def differences(
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    datasets: Collection[str] | None = None,
    parts: Parts | None = None,
) -> list[str]:
    """Generate everything again and say what is not as pinned; writes nothing.

    Parameters and errors as `update`.
    """
    pinned = store.pins()
    every = conditions_of(parts or installed_parts(), datasets)
    wrong: list[str] = []
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        for done, (preset, condition, pins, reason) in enumerate(generate(every, workers), start=1):
            where = f"{preset.name} {condition}"
            wrong += [f"{where}: cannot be generated: {reason}"] if reason else []
            wrong += [
                f"{where} {pin.split}: {said}"
                for pin in pins
                if (said := _wrong(pinned.get(pin.place), pin))
            ]
            report(done, len(every), where)
    return sorted(wrong)


def _wrong(pinned: Pin | None, pin: Pin) -> str:
    if pinned is None:
        return "not pinned"
    if pinned.version != pin.version:
        return f"version {pin.version}, pinned {pinned.version}"
    return pinned.difference(pin)


def conditions_of(
    parts: Parts, datasets: Collection[str] | None = None
) -> list[tuple[Preset, str]]:
    """List every dataset and condition, of the named ones, in order."""
    for name in sorted(datasets or ()):
        if name not in parts.presets:
            raise UnknownNameError("dataset", name, parts.presets)
    names = sorted(parts.presets if datasets is None else set(datasets))
    return [
        (parts.presets[name], condition)
        for name in names
        for condition in parts.presets[name].conditions
    ]


def generate(
    wanted: list[tuple[Preset, str]], workers: int
) -> Iterator[tuple[Preset, str, tuple[Pin, ...], str]]:
    """Generate datasets under conditions: each with its pins, or why there are none."""
    with closing(as_completed(_generate, wanted, workers if len(wanted) > 1 else 1)) as found:
        yield from found


def _generate(wanted: tuple[Preset, str]) -> tuple[Preset, str, tuple[Pin, ...], str]:
    preset, condition = wanted
    with one_thread():
        try:
            return preset, condition, generated_pins(preset, condition), ""
        except Exception as error:  # noqa: BLE001 - any error of a dataset is reported with its name
            return preset, condition, (), reason_of(error)
