"""Digests of code and of parameters: what a number depends on, and nothing else."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from types import FunctionType

from algorithms.chain import Chain, Scored
from algorithms.contract import Extractor
from benchmark.canonical import digest
from benchmark.contract import Preset
from benchmark.results.closure import FIRST_PARTY, Sources

#: Digits of a component's digest: two of a hundred components meet once in 1e15.
_COMPONENT_DIGITS = 16
#: What makes each stage of the data, extractors and models that it is handed, in order.
STAGES: Mapping[str, tuple[str, ...]] = {
    "data": ("benchmark.running.condition_data:render",),
    "features": (
        "benchmark.running.condition_data:correct_readings",
        "benchmark.running.condition_data:found_features",
    ),
    "predictions": ("benchmark.running.task:fit_and_predict",),
    "scores": ("benchmark.running.task:score_answers",),
}


def condition_digests(preset: Preset, sources: Sources | None = None) -> dict[str, str]:
    """Digest of everything a dataset's data and bounds depend on, by condition, in order.

    Parameters
    ----------
    preset
        Its parameters and the code of all that it is made of count.
    sources
        As they are now by default.
    """
    from benchmark.datasets.corrected import reference_condition  # noqa: PLC0415 - loads Numba

    code = (sources or Sources.as_they_are()).digest(*entries_of(preset))
    parameters = {name: digest(preset.parameters(name)) for name in preset.conditions}
    return {
        name: short_digest(
            {
                "dataset": preset.name,
                "version": preset.version,
                "parameters": own,
                # readings are corrected by those of the first condition with the same detector
                "references": parameters[reference_condition(preset, name)],
                "code": code,
            }
        )
        for name, own in parameters.items()
    }


def series_digest(series: object) -> str:
    """Digest of a series of synthetic features: of what it holds, and of the code of it all."""
    return short_digest(
        {"holds": series, "code": Sources.as_they_are().digest(*entries_of(series))}
    )


def method_digest(method: type[Extractor] | Scored, sources: Sources | None = None) -> str:
    """Digest of an implementation: its name, its version, the code it reaches."""
    return short_digest(
        {
            "name": method.about.name,
            "version": method.about.version,
            "code": (sources or Sources.as_they_are()).digest(*method_entries(method)),
        }
    )


def stage_digests(sources: Sources | None = None) -> dict[str, str]:
    """Digest of the code between data and numbers, by stage: how methods are run and judged.

    What hands stages on, keeps, times or stores them is not among it, as it changes no number: no
    stage's function or argument names it (`tests/benchmark/results/test_what_moves_digests.py`).
    """
    known = sources or Sources.as_they_are()
    return {name: short_digest(known.digest(*entries)) for name, entries in STAGES.items()}


def short_digest(value: object) -> str:
    """Digest of a value in as many digits as a component's has."""
    return digest(value)[:_COMPONENT_DIGITS]


def method_entries(method: type[Extractor] | Scored) -> tuple[str, ...]:
    """Return the classes that an implementation is made of, as `benchmark.results.closure` asks."""
    if isinstance(method, Chain):
        return (*_entries(Chain), *(entry for part in method.stages for entry in _entries(part)))
    return tuple(_entries(method))


def entries_of(instance: object) -> tuple[str, ...]:
    """Return the class of an instance and of every dataclass instance or function it holds."""
    return tuple(sorted(set(_entries_of(instance))))


def _entries_of(value: object) -> Iterator[str]:
    if value is None or isinstance(value, float | str | int):  # most of what a preset holds
        return
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from _entries(type(value))
        for part in dataclasses.fields(value):
            yield from _entries_of(getattr(value, part.name))
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from _entries_of(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _entries_of(item)
    elif isinstance(value, FunctionType):
        yield f"{value.__module__}:{value.__qualname__}"
    elif isinstance(value, type):
        yield from _entries(value)


def _entries(kind: type) -> Iterator[str]:
    """Yield a class and those of ours that it is derived from, however it was made."""
    ours = {*FIRST_PARTY, kind.__module__.partition(".")[0]} - {"builtins"}
    for base in kind.__mro__:
        if base.__module__.partition(".")[0] in ours:
            yield f"{base.__module__}:{base.__qualname__}"
