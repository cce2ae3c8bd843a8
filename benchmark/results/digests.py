"""Digests of code and of parameters: what a number depends on, and nothing else."""

from __future__ import annotations

import dataclasses
import weakref
from collections.abc import Iterator, Mapping
from types import FunctionType

from algorithms.chain import Chain, Scored
from algorithms.contract import Extractor
from benchmark.canonical import digest
from benchmark.contract import Preset
from benchmark.results.closure import closure_digest, module_path, syntax_digest

#: Digits of a component's digest: two of a hundred components meet once in 1e15.
_COMPONENT_DIGITS = 16
#: Modules that turn data and implementations into numbers.
_HARNESS = (
    "algorithms.kernels.reference_correction",
    "algorithms.pipeline",
    "algorithms.references",
    "benchmark.datasets.benches",
    "benchmark.datasets.corrected",
    "benchmark.datasets.method_bound",
    "benchmark.metrics.rings",
    "benchmark.metrics.score",
    "benchmark.running.condition_data",
    "benchmark.running.task",
)


#: By the identity of a preset, which never changes: itself, digest of the code, digest of all.
_known: dict[int, tuple[weakref.ref[Preset], str, str]] = {}


def dataset_digest(preset: Preset) -> str:
    """Digest of everything a dataset's data and bounds depend on, under all its conditions.

    Spelling a preset's parameters takes longer than finding out whether its code has changed: a
    process that asks again spells them once.
    """
    code = closure_digest(*modules_of(preset))
    if (known := _known.get(id(preset))) and known[0]() is preset and known[1] == code:
        return known[2]
    found = short_digest(
        {
            "dataset": preset.name,
            "version": preset.version,
            "parameters": {name: preset.parameters(name) for name in preset.conditions},
            "code": code,
        }
    )
    _known[id(preset)] = (weakref.ref(preset), code, found)
    return found


def series_digest(series: object) -> str:
    """Digest of a series of synthetic features: of what it holds, and of the code of it all."""
    return short_digest({"holds": series, "code": closure_digest(*modules_of(series))})


def method_digest(method: type[Extractor] | Scored) -> str:
    """Digest of an implementation: its name, its version, the code it reaches."""
    modules = method.modules if isinstance(method, Chain) else (method.__module__,)
    return short_digest(
        {
            "name": method.about.name,
            "version": method.about.version,
            "code": closure_digest(*modules),
        }
    )


def harness_digest() -> str:
    """Digest of the code between data and numbers: how methods are run, what is computed."""
    return modules_digest(*_HARNESS)


def modules_digest(*names: str) -> str:
    """Digest of the code of these modules themselves, not of what they import.

    Raises
    ------
    FileNotFoundError
        When one of them has no source file.
    """
    return short_digest([_syntax(name) for name in names])


def _syntax(module: str) -> str:
    path = module_path(module)
    if path is None:
        raise FileNotFoundError(f"no source file found for module {module!r}")
    return syntax_digest(path)


def short_digest(value: object) -> str:
    """Digest of a value in as many digits as a component's has."""
    return digest(value)[:_COMPONENT_DIGITS]


def modules_of(instance: object) -> tuple[str, ...]:
    """Modules of an instance's class and of every dataclass instance or function it holds."""
    return tuple(sorted(set(_modules_of(instance))))


def _modules_of(value: object) -> Iterator[str]:
    if value is None or isinstance(value, float | str | int):  # most of what a preset holds
        return
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield type(value).__module__
        for part in dataclasses.fields(value):
            yield from _modules_of(getattr(value, part.name))
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from _modules_of(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _modules_of(item)
    elif isinstance(value, FunctionType):
        yield value.__module__
