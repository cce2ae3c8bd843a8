"""Digests of code and of parameters: what a number depends on, and nothing else."""

from __future__ import annotations

import dataclasses
import weakref
from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import TYPE_CHECKING, NamedTuple

from algorithms.chain import Chain, Scored
from algorithms.contract import Extractor
from benchmark.canonical import digest
from benchmark.results.modules import FIRST_PARTY, STAGES, modules_digest

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset


class _Described(NamedTuple):
    """What follows from a preset alone: its modules, and digests of its parameters by condition."""

    preset: weakref.ref[Preset]
    modules: tuple[str, ...]
    parameters: dict[str, str]


#: By identity: presets do not change, and every experiment asks for the digests of all of them.
_DESCRIBED: dict[int, _Described] = {}
#: Digits of a component's digest: two of a hundred components meet once in 1e15.
DIGITS = 16


def condition_digests(preset: Preset) -> dict[str, str]:
    """Digest of everything a dataset's data and bounds depend on, by condition, in order.

    Its parameters and the modules of all that it is made of count.
    """
    from benchmark.datasets.corrected import reference_condition  # noqa: PLC0415 - loads Numba

    described = _describe(preset)
    code, parameters = modules_digest(*described.modules), described.parameters
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


def modules_of_preset(preset: Preset) -> tuple[str, ...]:
    """Return `modules_of` a preset, found once."""
    return _describe(preset).modules


def _describe(preset: Preset) -> _Described:
    known = _DESCRIBED.get(id(preset))
    if known is None or known.preset() is not preset:
        parameters = {name: digest(preset.parameters(name)) for name in preset.conditions}
        known = _Described(weakref.ref(preset), modules_of(preset), parameters)
        _DESCRIBED[id(preset)] = known
    return known


def series_digest(series: object) -> str:
    """Digest of a series of synthetic features: of what it holds, and of the code of it all."""
    return short_digest({"holds": series, "code": modules_digest(*modules_of(series))})


def method_digest(method: type[Extractor] | Scored) -> str:
    """Digest of an implementation: its name, its version, the modules that it imports."""
    return short_digest(
        {
            "name": method.about.name,
            "version": method.about.version,
            "code": modules_digest(*method_modules(method)),
        }
    )


def stage_digests() -> dict[str, str]:
    """Digest of the modules between data and numbers, by stage: how methods are run and judged."""
    return {name: short_digest(modules_digest(module)) for name, module in STAGES.items()}


def short_digest(value: object) -> str:
    """Digest of a value in as many digits as a component's has."""
    return digest(value)[:DIGITS]


def method_modules(method: type[Extractor] | Scored) -> tuple[str, ...]:
    """Return the modules of the classes that an implementation is made of."""
    classes = (Chain, *method.stages) if isinstance(method, Chain) else (method,)
    return tuple(sorted({module for one in classes for module in _of_class(one)}))


def modules_of(instance: object) -> tuple[str, ...]:
    """Return the modules of an instance and of every dataclass instance or function it holds."""
    return tuple(sorted(set(_held(instance))))


def _held(value: object) -> Iterator[str]:
    if value is None or isinstance(value, float | str | int):  # most of what a preset holds
        return
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        yield from _of_class(type(value))
        for part in dataclasses.fields(value):
            yield from _held(getattr(value, part.name))
    elif isinstance(value, Mapping):
        for item in value.values():
            yield from _held(item)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _held(item)
    elif isinstance(value, FunctionType):
        yield value.__module__
    elif isinstance(value, type):
        yield from _of_class(value)


def _of_class(kind: type) -> Iterator[str]:
    """Yield the modules of a class and of those of ours that it is derived from."""
    ours = {*FIRST_PARTY, kind.__module__.partition(".")[0]} - {"builtins"}
    for base in kind.__mro__:
        if base.__module__.partition(".")[0] in ours:
            yield base.__module__
