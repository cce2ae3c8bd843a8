"""One spelling for a value: what digests are made of, and what cards say of a dataset."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import math
from collections.abc import Callable, Mapping
from collections.abc import Set as AbstractSet
from enum import Enum
from typing import Any

import numpy as np

#: Hexadecimal digits of a digest: 16 bytes.
DIGITS = 32

Number = Callable[[float], object]
Members = Callable[[Any], Mapping[str, object]]


def canonical_json(value: object) -> str:
    """One spelling for a value: sorted keys, no spaces, no NaN.

    Floats keep 12 significant digits, so that the last bits of a platform's sine do not make
    another key. Accepts dataclasses, enums, arrays, sets, mappings, sequences and plain values.
    """
    return json.dumps(
        to_plain(value, _round_to, _arguments),
        sort_keys=True,
        separators=(",", ":"),
        ensure_ascii=False,
        allow_nan=False,
    )


def digest(value: object) -> str:
    """SHA-256 of `canonical_json(value)`, 32 hexadecimal digits."""
    return hashlib.sha256(canonical_json(value).encode()).hexdigest()[:DIGITS]


def to_plain(value: object, number: Number, members: Members) -> Any:
    """Return a value as JSON has it: objects, arrays, strings, numbers, booleans and null.

    `number` spells a float, `members` says what of a dataclass instance is spelt, by name.
    TypeError for a value that has no canonical spelling.
    """
    if value is None or (isinstance(value, str | int) and not isinstance(value, Enum)):
        return value
    if isinstance(value, float):
        return number(float(value))
    if isinstance(value, Enum):
        return to_plain(value.value, number, members)
    if isinstance(value, np.generic):
        return to_plain(value.item(), number, members)
    if isinstance(value, np.ndarray):
        return {"dtype": value.dtype.str, "values": to_plain(value.tolist(), number, members)}
    return _plain_container(value, number, members)


def _plain_container(value: object, number: Number, members: Members) -> Any:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        value = members(value)
    if isinstance(value, Mapping):
        return {
            str(to_plain(name, number, members)): to_plain(item, number, members)
            for name, item in value.items()
        }
    if isinstance(value, AbstractSet):
        return sorted((to_plain(item, number, members) for item in value), key=canonical_json)
    if isinstance(value, list | tuple):
        return [to_plain(item, number, members) for item in value]
    raise TypeError(f"{type(value).__name__} has no canonical spelling: {value!r}")


def _round_to(value: float) -> object:
    return float(f"{value:.12g}") if math.isfinite(value) else repr(value)


def _arguments(instance: Any) -> Mapping[str, object]:
    return {f.name: getattr(instance, f.name) for f in dataclasses.fields(instance) if f.init}
