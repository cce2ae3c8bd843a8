"""Strict reading of JSON: unique keys, finite numbers, bounded size and depth; no traceback.

Pydantic would keep the last of two equal keys in silence, and its JSON errors know no line of the
file; so the standard library reads, with hooks that refuse.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from files.reading import LARGEST, FileRefusedError, read_text

#: Deeper than any document of the project, and far from where Python gives up.
DEEPEST = 50


def read_json(path: Path, largest: int = LARGEST) -> Any:
    """Return the value that a JSON file holds.

    Raises
    ------
    FileNotFoundError
        Nothing has this name.
    FileRefusedError
        It is no file of JSON (`parse_json`), or `file_bytes.read_text` refuses it.
    """
    return parse_json(read_text(path, largest), path)


def parse_json(text: str, path: Path) -> Any:
    """Return the value of a JSON text; `path` is named where it is refused.

    Raises
    ------
    FileRefusedError
        For broken JSON, a key that stands twice in an object, a number that is not finite (NaN,
        Infinity, 1e999), and arrays or objects nested deeper than `DEEPEST`.
    """
    try:
        value = json.loads(
            text,
            object_pairs_hook=_unique,
            parse_constant=_refused,
            parse_float=_finite,
        )
        _refuse_deep(value)
    except json.JSONDecodeError as error:
        raise FileRefusedError(path, f"not JSON: {error.msg}", error.lineno) from error
    except RecursionError as error:
        raise FileRefusedError(path, f"not JSON: nested deeper than {DEEPEST}") from error
    except ValueError as error:
        raise FileRefusedError(path, f"not JSON: {error}") from error
    return value


def require_members(value: Any, path: Path, expected: Mapping[str, type | tuple[type, ...]]) -> Any:
    """Return an object that has these members and no others, each of its type.

    Raises
    ------
    FileRefusedError
        Naming the member that is missing, unknown or of another type. A truth value is no number.
    """
    if not isinstance(value, dict):
        raise FileRefusedError(path, f"expected an object, got {_kind(value)}")
    for name, kind in expected.items():
        if name not in value:
            raise FileRefusedError(path, f"the member {name!r} is missing")
        require_type(value[name], kind, path, name)
    unknown = sorted(value.keys() - expected.keys())
    if unknown:
        raise FileRefusedError(
            path, f"unknown member {unknown[0]!r}; expected {', '.join(expected)}"
        )
    return value


def require_type(
    value: Any, kind: type | tuple[type, ...], path: Path, where: str, line: int | None = None
) -> Any:
    """Return a value of this type; FileRefusedError naming where another stands."""
    kinds = kind if isinstance(kind, tuple) else (kind,)
    if not isinstance(value, kinds) or (isinstance(value, bool) and bool not in kinds):
        wanted = " or ".join(_NAMES.get(one, one.__name__) for one in kinds)
        got = f"{_kind(value)} {value!r}"[:80]
        raise FileRefusedError(path, f"{where}: expected {wanted}, got {got}", line)
    return value


def refuse_unless(holds: bool, path: Path, reason: str) -> None:
    """Raise FileRefusedError with a reason unless something holds."""
    if not holds:
        raise FileRefusedError(path, reason)


_NAMES: Mapping[type, str] = {
    dict: "an object",
    list: "an array",
    str: "text",
    int: "a whole number",
    float: "a number",
    bool: "a truth value",
    type(None): "null",
}


def _kind(value: Any) -> str:
    return _NAMES.get(type(value), type(value).__name__)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        seen: set[str] = set()
        for name, _ in pairs:
            if name in seen:
                raise ValueError(f"the key {name!r} stands twice in an object")
            seen.add(name)
    return found


def _refused(word: str) -> Any:
    raise ValueError(f"{word} is no number")


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"{text[:40]} is out of range")
    return number


def _refuse_deep(value: Any, left: int = DEEPEST) -> None:
    if isinstance(value, dict | list):
        if left == 0:
            raise ValueError(f"nested deeper than {DEEPEST}")
        for inner in value.values() if isinstance(value, dict) else value:
            _refuse_deep(inner, left - 1)
