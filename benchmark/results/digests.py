"""Digests: of code, of parameters, of data; what a number depends on, and nothing else."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from collections.abc import Set as AbstractSet
from enum import Enum
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Model
from benchmark.plan.parts import Preset, Samples
from benchmark.results.closure import closure_digest, module_path, syntax_digest

_DIGITS = 32  # hexadecimal, 16 bytes
#: Digits of a component's digest: two of a hundred components meet once in 1e15.
_COMPONENT_DIGITS = 16
#: Samples at the start of a split that have a hash of their own, for a check in seconds.
HEAD = 4
#: Modules that turn data and implementations into numbers.
_HARNESS = (
    "algorithms.pipeline",
    "benchmark.metrics.rings",
    "benchmark.metrics.score",
    "benchmark.running.task",
    "benchmark.sweeps.measure",
)


def canonical_json(value: object) -> str:
    """One spelling for a value: sorted keys, no spaces, no NaN.

    Floats keep 12 significant digits, so that the last bits of a platform's sine do not make
    another key. Accepts dataclasses, enums, arrays, sets, mappings, sequences and plain values.

    Raises
    ------
    TypeError
        For a value that has no canonical spelling.
    """
    return json.dumps(
        _plain(value), sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False
    )


def digest(value: object) -> str:
    """SHA-256 of `canonical_json(value)`, 32 hexadecimal digits."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()[:_DIGITS]


def samples_hash(samples: Samples) -> str:
    """SHA-256 (32 hexadecimal digits) over the arrays of one split: names, types, shapes, bytes."""
    return _arrays_hash(_arrays_of(samples))


def head_hash(samples: Samples) -> str:
    """`samples_hash` of the first `HEAD` samples: those that ``generate(..., n=HEAD)`` gives."""
    return _arrays_hash(
        {name: None if a is None else a[:HEAD] for name, a in _arrays_of(samples).items()}
    )


def _arrays_of(samples: Samples) -> dict[str, NDArray[Any] | None]:
    arrays: dict[str, NDArray[Any] | None] = {
        name: getattr(samples, name) for name in ("observations", "sun", "origin_px")
    }
    context: Mapping[str, NDArray[Any]] = getattr(samples, "context", None) or {}
    arrays.update((f"context.{name}", context[name]) for name in sorted(context))
    return arrays


def _arrays_hash(arrays: Mapping[str, NDArray[Any] | None]) -> str:
    state = hashlib.sha256()
    for name, array in arrays.items():
        if array is None:
            state.update(f"{name} none\n".encode())
            continue
        little = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<"), copy=False)
        state.update(f"{name} {little.dtype.descr} {little.shape}\n".encode())
        state.update(little.reshape(-1).view(np.uint8).data)  # not copied: frames may be large
    return state.hexdigest()[:_DIGITS]


def dataset_digest(preset: Preset) -> str:
    """Digest of everything a dataset's data and bounds depend on, under all its conditions."""
    return _component(
        {
            "dataset": preset.name,
            "version": preset.version,
            "parameters": {name: preset.parameters(name) for name in preset.conditions},
            "code": closure_digest(*preset_modules(preset)),
        }
    )


def method_digest(method: type[Extractor | Model]) -> str:
    """Digest of an implementation: its name, its version, the code it reaches."""
    return _component(
        {
            "name": method.about.name,
            "version": method.about.version,
            "code": closure_digest(method.__module__),
        }
    )


def module_digest(*modules: str) -> str:
    """Digest of modules and of the code they reach."""
    return _component(closure_digest(*modules))


def harness_digest() -> str:
    """Digest of the code between data and numbers: how methods are run, what is computed."""
    return _component([_syntax(name) for name in _HARNESS])


def _syntax(module: str) -> str:
    path = module_path(module)
    if path is None:
        raise FileNotFoundError(f"no source file found for module {module!r}")
    return syntax_digest(path)


def _component(value: object) -> str:
    return digest(value)[:_COMPONENT_DIGITS]


def preset_modules(preset: Preset) -> tuple[str, ...]:
    """Modules of the preset's class and of every dataclass instance or function it holds."""
    return tuple(sorted(set(_modules_of(preset))))


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


def _plain(value: object) -> object:
    if value is None or (isinstance(value, str | int) and not isinstance(value, Enum)):
        return value
    if isinstance(value, float):
        return float(f"{value:.12g}") if math.isfinite(value) else repr(value)
    if isinstance(value, Enum):
        return _plain(value.value)
    if isinstance(value, np.generic):
        return _plain(value.item())
    if isinstance(value, np.ndarray):
        return {"dtype": value.dtype.str, "values": _plain(value.tolist())}
    return _plain_container(value)


def _plain_container(value: object) -> object:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: _plain(getattr(value, f.name)) for f in dataclasses.fields(value) if f.init}
    if isinstance(value, Mapping):
        return {str(_plain(name)): _plain(item) for name, item in value.items()}
    if isinstance(value, AbstractSet):
        return sorted((_plain(item) for item in value), key=canonical_json)
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    raise TypeError(f"{type(value).__name__} has no canonical spelling: {value!r}")
