"""Keys of results and hashes of data: what a number depends on, and nothing else.

A key digests dataset, implementation, code, harness and metric versions and the seed. Wall time,
host and library versions are fields of a run and never part of a key.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from enum import Enum
from types import FunctionType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Extractor, Model, parameters
from benchmark.content_key_closure import closure_digest
from benchmark.plan_parts import Preset, Samples
from benchmark.scoring import METRIC_VERSION

#: Layout of a row of scores.jsonl; raised when a field changes its meaning.
SCHEMA_VERSION = 1
#: Raised when the runner feeds implementations differently, so that scores change on purpose.
HARNESS_VERSION = 1

_DIGITS = 32  # hexadecimal, 16 bytes


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
    state = hashlib.sha256()
    arrays: dict[str, NDArray[Any] | None] = {
        name: getattr(samples, name) for name in ("observations", "sun", "origin_px")
    }
    context: Mapping[str, NDArray[Any]] = getattr(samples, "context", None) or {}
    arrays.update((f"context.{name}", context[name]) for name in sorted(context))
    for name, array in arrays.items():
        if array is None:
            state.update(f"{name} none\n".encode())
            continue
        little = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<"), copy=False)
        state.update(f"{name} {little.dtype.descr} {little.shape}\n".encode())
        state.update(little.reshape(-1).view(np.uint8).data)  # not copied: frames may be large
    return state.hexdigest()[:_DIGITS]


def joined_hash(split_hashes: Mapping[str, str]) -> str:
    """One hash for the splits of a dataset under one condition."""
    return digest(dict(split_hashes))


class Specifications:
    """`data_specification` of datasets, each digested once: code as it is when first asked for."""

    def __init__(self) -> None:
        self._known: dict[tuple[str, str], str] = {}
        self._code: dict[str, str] = {}

    def of(self, preset: Preset, condition: str) -> str:
        """Return the digest of a dataset under one condition; datasets are told by name."""
        place = preset.name, condition
        if place not in self._known:
            if preset.name not in self._code:
                self._code[preset.name] = preset_code(preset)
            self._known[place] = data_specification(preset, condition, self._code[preset.name])
        return self._known[place]


def data_specification(preset: Preset, condition: str, code: str | None = None) -> str:
    """Digest of everything generated data depend on: names, version, parameters and code.

    `code` is `preset_code(preset)` where that is known.
    """
    return digest(
        {
            "dataset": preset.name,
            "version": preset.version,
            "condition": condition,
            "parameters": preset.parameters(condition),
            "code": code or preset_code(preset),
        }
    )


def preset_code(preset: Preset) -> str:
    """Digest of the code that generates a preset's data and its bound."""
    return closure_digest(*preset_modules(preset))


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


def seed(*names: str) -> int:
    """Make a 31-bit seed of names, never of a position in a loop."""
    return int.from_bytes(hashlib.sha256("\0".join(names).encode()).digest()[:4], "big") >> 1


def cell_key(
    specification: str,
    data_hash: str | None,
    extractor: str,
    model: str,
    cell_seed: int,
) -> str:
    """Key of the result of one extractor and one model on one dataset and condition.

    Parameters
    ----------
    specification
        `data_specification` of the dataset and condition.
    data_hash
        `joined_hash` of its splits; None where the data could not be generated.
    extractor, model
        `digest` of the `implementation_key` of each.
    cell_seed
        `seed` of the cell's names.
    """
    return digest(
        {
            "schema": SCHEMA_VERSION,
            "harness": HARNESS_VERSION,
            "metric": METRIC_VERSION,
            "specification": specification,
            "data": data_hash,
            "extractor": extractor,
            "model": model,
            "seed": cell_seed,
        }
    )


def implementation_key(
    implementation: type[Extractor | Model],
    build: Callable[[], Extractor | Model],
    code: Callable[[str], str] = closure_digest,
) -> dict[str, object]:
    """Say what of an implementation enters a key: name, version, parameters, code.

    `build` makes it with the parameters that are scored; one that fails to be built has None.
    `code` digests what its module reaches.
    """
    try:
        built = parameters(build())
    except Exception:  # noqa: BLE001 - the same error becomes the row's reason when measured
        built = None
    return {
        "name": implementation.name,
        "version": implementation.version,
        "parameters": built,
        "code": code(implementation.__module__),
    }


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
