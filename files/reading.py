"""Strict reading of text, JSON and numbers: what cannot be taken is refused with its place.

Pydantic would keep the last of two equal keys in silence, and its errors of JSON know no file; so
the standard library reads, with hooks that refuse.
"""

from __future__ import annotations

import json
import math
import os
import re
import tomllib
from pathlib import Path
from typing import Any

#: Bytes: more than any table or document of the project holds, and less than hurts.
LARGEST = 50_000_000
#: Marks that no text of ours holds; the last one stands where an earlier program lost a letter.
_MARKS = {"\ufeff": "a byte-order mark", "\x00": "a null character", "\ufffd": "a lost letter"}
_NUMBER = re.compile(r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
#: Strings and comments of TOML, also those without an end, which every later quote would look for.
_QUOTED = re.compile(
    r"""\"{3}(?:[^\\]|\\.)*?(?:\"{3}|\Z)|'{3}.*?(?:'{3}|\Z)"""
    r"""|"(?:[^"\\\n]|\\.)*+"?|'[^'\n]*+'?|\#[^\n]*+""",
    re.DOTALL,
)
#: A key of so many parts: reading one takes the square of their number, 8 s and 1.6 GB of 20,000.
_DEEP_KEY = re.compile(r"(?<![\w-])(?:[\w-]++[ \t]*+\.[ \t]*+){20}")
_WHOLE = re.compile(r"[+-]?[0-9]{1,40}")


class FileRefusedError(ValueError):
    """A file cannot be taken: `reason` is what was expected and what came, `line` counts from 1."""

    def __init__(self, path: Path, reason: str, line: int | None = None) -> None:
        self.path, self.reason, self.line = path, reason, line
        super().__init__(f"{path}{'' if line is None else f', line {line}'}: {reason}")


def read_bytes(path: Path, largest: int = LARGEST) -> bytes:
    """Return what a regular file holds; FileNotFoundError where nothing has this name.

    FileRefusedError for what is no regular file, which may never end, cannot be read, or is larger
    than `largest`.
    """
    try:
        if os.path.lexists(path) and not path.is_file():
            kind = "a directory" if path.is_dir() else "a named pipe, a device or a broken link"
            raise FileRefusedError(path, f"expected a file, got {kind}")
        with path.open("rb") as file:
            data = file.read(largest + 1)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise FileRefusedError(path, f"cannot be read: {error.strerror or error}") from error
    if len(data) > largest:
        raise FileRefusedError(path, f"expected at most {largest} bytes, got more")
    return data


def read_text(path: Path, largest: int = LARGEST) -> str:
    """Return what a file of plain UTF-8 holds, line ends as they are; else as `read_bytes`."""
    data = read_bytes(path, largest)
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        said = f"not UTF-8 text: byte 0x{data[error.start]:02x}"
        raise FileRefusedError(path, said, line) from error
    for mark, name in _MARKS.items():
        if mark in text:
            said = f"expected plain UTF-8, got {name} (U+{ord(mark):04X})"
            raise FileRefusedError(path, said, text[: text.index(mark)].count("\n") + 1)
    return text


def read_json(path: Path, largest: int = LARGEST) -> Any:
    """Return the value of a JSON file; raises as `read_text` and `parse_json`."""
    return parse_json(read_text(path, largest), path)


def parse_json(text: str, path: Path) -> Any:
    """Return the value of a JSON text; `path` is named where it is refused.

    FileRefusedError for broken or too deeply nested JSON, a key that stands twice in an object, and
    a number that is not finite (NaN, Infinity, 1e999).
    """
    try:
        return json.loads(
            text, object_pairs_hook=_unique, parse_constant=_finite, parse_float=_finite
        )
    except json.JSONDecodeError as error:
        raise FileRefusedError(path, f"not JSON: {error.msg}", error.lineno) from error
    except RecursionError as error:
        raise FileRefusedError(path, "not JSON: nested too deeply") from error
    except ValueError as error:
        raise FileRefusedError(path, f"not JSON: {error}") from error


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in pairs:
        if name in found:
            raise ValueError(f"the key {name[:40]!r} stands twice in an object")
        found[name] = value
    return found


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"expected a finite number, got {text[:40]}")
    return number


def parse_toml(text: str) -> dict[str, Any]:
    """Return what a TOML text holds.

    Raises
    ------
    ValueError
        Where it is none, or a key has more than 20 parts.
    RecursionError
        Where it is nested too deeply.
    """
    bare = _QUOTED.sub(lambda found: "s" + "\n" * found[0].count("\n"), text)
    if found := _DEEP_KEY.search(bare):
        line = bare.count("\n", 0, found.start()) + 1
        raise ValueError(f"expected keys of at most 20 parts (at line {line}, column 1)")
    return tomllib.loads(text)


def require_type(value: Any, kind: Any, path: Path) -> None:
    """Raise FileRefusedError, naming the first flaw, unless Pydantic takes a value for a type.

    Strictly: text, truth values and numbers are not taken for each other.
    """
    from pydantic import TypeAdapter, ValidationError  # noqa: PLC0415 - slow to load

    try:
        TypeAdapter(kind).validate_python(value, strict=True)
    except ValidationError as error:
        flaw = error.errors(include_url=False)[0]
        got = "" if flaw["type"] == "missing" else f", got {flaw['input']!r:.80}"
        place = "/".join(map(str, flaw["loc"]))
        raise FileRefusedError(path, f"{place}{place and ': '}{flaw['msg']}{got}") from error


def parse_decimal(text: str) -> float:
    """Read a finite number; ValueError for others, and what only Python takes: 1_29, nan."""
    if not _NUMBER.fullmatch(text):
        raise ValueError(f"expected a number, got {text[:40]!r}")
    return _finite(text)


def parse_integer(text: str) -> int:
    """Read a whole number of up to 40 digits; ValueError for anything else."""
    if not _WHOLE.fullmatch(text):
        raise ValueError(f"expected a whole number, got {text[:40]!r}")
    return int(text)
