"""Pins of data: the hash of every dataset, condition and split, whatever can be measured on it.

A run pins what it measures; here is pinned what remains. A pin made by the code as it is stays, so
that bringing pins up to date renders only what is new or has changed.
"""

from __future__ import annotations

import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path

from joblib import Parallel, delayed

from benchmark.content_key import Specifications
from benchmark.plan_parts import SPLITS, Parts, Preset, UnknownNameError, installed
from benchmark.runner_progress import ProgressCallback, terminal_progress
from benchmark.runner_timing import one_thread
from benchmark.runner_unit import generated_pins, reason_of
from benchmark.store import Pin, Store
from benchmark.store_journal import Journal, locked

Condition = tuple[str, str]  # (dataset, condition)
Place = tuple[str, str, str]  # (dataset, condition, split)


@dataclass(frozen=True)
class Pinned:
    """What was pinned.

    Attributes
    ----------
    store
        Where.
    kept, renewed
        How many conditions were pinned for the code as it is, how many are now.
    warnings
        Data that cannot be generated.
    seconds
        How long it took.
    """

    store: Path
    kept: int
    renewed: int
    warnings: tuple[str, ...]
    seconds: float


def outdated(
    store: Store,
    datasets: Collection[str] | None = None,
    *,
    parts: Parts | None = None,
    specifications: Specifications | None = None,
) -> list[Condition]:
    """List the conditions with a split that is not pinned for the code as it is, in order.

    Parameters
    ----------
    store
        Where the pins are.
    datasets
        Names; all by default.
    parts
        Datasets; what is installed by default.
    specifications
        Digests of datasets to share with other calls of the same run.

    Raises
    ------
    UnknownNameError
        For a dataset that is not installed.
    """
    specifications = specifications or Specifications()
    known = parts or installed()
    pins = Journal(store).progress().pins
    return [
        (preset.name, condition)
        for preset in _chosen(known, datasets)
        for condition in preset.conditions
        if not _is_pinned(preset, condition, pins, specifications)
    ]


def places(parts: Parts | None = None) -> set[Place]:
    """Return everything there is to pin: (dataset, condition, split)."""
    return {
        (preset.name, condition, split)
        for preset in (parts or installed()).presets.values()
        for condition in preset.conditions
        for split in SPLITS
    }


def update(
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    datasets: Collection[str] | None = None,
    parts: Parts | None = None,
    specifications: Specifications | None = None,
) -> Pinned:
    """Generate what is not pinned for the code as it is, and pin it.

    What is generated is on disk before the next is awaited, so a killed call loses only what was
    in flight.

    Parameters
    ----------
    store
        Where the pins are.
    workers
        Number of processes; the hashes do not depend on it.
    progress
        As `benchmark.runner.run`.
    datasets
        Names; all by default.
    parts
        Datasets; what is installed by default.
    specifications
        Digests of datasets to share with other calls of the same run.

    Raises
    ------
    UnknownNameError
        For a dataset that is not installed.
    StoreLockedError
        When a runner writes to the store.
    """
    if workers < 1:
        raise ValueError(f"workers must be at least 1; got {workers}")
    started = time.perf_counter()
    known = parts or installed()
    specifications = specifications or Specifications()
    presets = _chosen(known, datasets)
    with locked(store):
        journal = Journal(store)
        journal.cut_torn_line()
        every = [(preset, condition) for preset in presets for condition in preset.conditions]
        there = places(known)
        if not journal.exists():
            stored = store.pins()
            if stored.keys() <= there and all(
                _is_pinned(*one, stored, specifications) for one in every
            ):
                seconds = time.perf_counter() - started
                return Pinned(store.directory, len(every), 0, (), seconds)
        held = journal.progress()
        missing = [one for one in every if not _is_pinned(*one, held.pins, specifications)]
        warnings: list[str] = []
        renewed = 0
        with terminal_progress() if progress is None else nullcontext(progress) as report:
            report(0, len(missing), "")
            for done, (preset, condition, pins, reason) in enumerate(
                _generated(missing, workers), start=1
            ):
                journal.append(pins, [])
                held.pins.update((pin.place, pin) for pin in pins)
                renewed += bool(pins)
                warnings += [_failure(preset, condition, reason)] if reason else []
                report(done, len(missing), f"{preset.name} {condition}")
        current = [pin for place, pin in held.pins.items() if place in there]
        if journal.exists() or len(current) != len(held.pins):
            store.write(held.rows.values(), held.runs.values(), current)
            journal.remove()
    return Pinned(
        store.directory,
        len(every) - len(missing),
        renewed,
        tuple(warnings),
        time.perf_counter() - started,
    )


def differences(
    store: Store,
    workers: int = 1,
    progress: ProgressCallback | None = None,
    *,
    datasets: Collection[str] | None = None,
    parts: Parts | None = None,
) -> list[str]:
    """Generate everything again and say what is not as pinned; writes nothing.

    Parameters and errors as `update`. Hashes hold on the machine's kind they were made on; see
    `benchmark.leaderboard_check.RELATIVE_TOLERANCE`.
    """
    pinned = Journal(store).progress().pins
    presets = _chosen(parts or installed(), datasets)
    every = [(preset, condition) for preset in presets for condition in preset.conditions]
    wrong: list[str] = []
    with terminal_progress() if progress is None else nullcontext(progress) as report:
        for done, (preset, condition, pins, reason) in enumerate(
            _generated(every, workers), start=1
        ):
            wrong += [_failure(preset, condition, reason)] if reason else []
            wrong += [line for pin in pins if (line := _difference(pinned.get(pin.place), pin))]
            report(done, len(every), f"{preset.name} {condition}")
    return sorted(wrong)


def _chosen(parts: Parts, datasets: Collection[str] | None) -> list[Preset]:
    if datasets is None:
        return [parts.presets[name] for name in sorted(parts.presets)]
    for name in sorted(datasets):
        if name not in parts.presets:
            raise UnknownNameError("dataset", name, parts.presets)
    return [parts.presets[name] for name in sorted(set(datasets))]


def _is_pinned(
    preset: Preset,
    condition: str,
    pins: Mapping[Place, Pin],
    specifications: Specifications,
) -> bool:
    found = [pins.get((preset.name, condition, split)) for split in SPLITS]
    if None in found:
        return False
    specification = specifications.of(preset, condition)
    return all(pin is not None and pin.specification == specification for pin in found)


def _difference(pinned: Pin | None, pin: Pin) -> str:
    where = f"{pin.dataset} {pin.condition} {pin.split}"
    if pinned is None:
        return f"{where}: not pinned"
    if pinned.specification != pin.specification:
        return f"{where}: pinned for other code or parameters"
    for name in ("data_hash", "n", "bound_deg"):
        if getattr(pinned, name) != getattr(pin, name):
            return f"{where}: {name} {getattr(pin, name)}, pinned {getattr(pinned, name)}"
    return ""


def _failure(preset: Preset, condition: str, reason: str) -> str:
    return f"{preset.name} {condition}: cannot be generated: {reason}"


def _generated(
    wanted: list[tuple[Preset, str]], workers: int
) -> Iterator[tuple[Preset, str, tuple[Pin, ...], str]]:
    if workers == 1 or len(wanted) < 2:
        yield from (_generate(preset, condition) for preset, condition in wanted)
        return
    parallel = Parallel(n_jobs=workers, return_as="generator_unordered", batch_size=1)
    yield from parallel(delayed(_generate)(preset, condition) for preset, condition in wanted)


def _generate(preset: Preset, condition: str) -> tuple[Preset, str, tuple[Pin, ...], str]:
    with one_thread():
        try:
            return preset, condition, generated_pins(preset, condition), ""
        except Exception as error:  # noqa: BLE001 - any error of a dataset is told with its name
            return preset, condition, (), reason_of(error)
