"""A TOML file with the line on which each of its keys stands."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from survey_data.additions.faults import Fault, FaultsError, read_text

Place = tuple[str | int, ...]
"""Keys and positions that lead to a value, such as ``("model", 0, "basis")``."""

_MOST_BYTES = 1_000_000
_TABLE = re.compile(r"\s*\[(\[)?\s*\"?([\w-]+)\"?\s*\]")
_KEY = re.compile(r"\s*([\w-]+)\s*=")
_SYNTAX = re.compile(r"^(.*) \(at (?:line (\d+), column \d+|(end of document))\)$", re.DOTALL)


@dataclass(frozen=True)
class TomlDocument:
    """Values of a TOML file, and their lines."""

    name: str
    values: Mapping[str, Any]
    lines: Mapping[Place, int]

    def line(self, *place: str | int) -> int:
        """Return the line of a value, or of the nearest thing around it that has one."""
        for end in range(len(place), 0, -1):
            if place[:end] in self.lines:
                return self.lines[place[:end]]
        return 1


def read_toml(path: Path) -> TomlDocument:
    """Read a TOML file.

    Raises
    ------
    FaultsError
        It cannot be read, or is no TOML; says where.
    """
    return parse_toml(read_text(path, _MOST_BYTES), path.name)


def parse_toml(text: str, name: str) -> TomlDocument:
    """Read the text of a TOML file; raises as `read_toml` does."""
    try:
        values = tomllib.loads(text.replace("\r\n", "\n"))
    except ValueError as error:  # tomllib's own, and a number of too many digits
        said = _SYNTAX.match(str(error))
        last = text.count("\n") + 1
        line = None if said is None else int(said[2]) if said[2] else last
        message = f"no valid TOML: {said[1] if said else error}"
        raise FaultsError(name, [Fault(line, message)]) from error
    except RecursionError as error:
        raise FaultsError(name, [Fault(None, "nested too deeply")]) from error
    return TomlDocument(name, values, _lines(text))


def _lines(text: str) -> dict[Place, int]:
    """Return the line of each table and key; of a value that is written over several, the first."""
    found: dict[Place, int] = {}
    table: Place = ()
    counted: dict[str, int] = {}
    quote = ""
    for number, line in enumerate(text.splitlines(), start=1):
        inside = quote
        for mark in re.findall(r'"""|\'\'\'', line):
            quote = "" if quote == mark else quote or mark
        if inside:
            continue
        if opened := _TABLE.match(line):
            name = opened[2]
            if opened[1]:
                at = counted.get(name, 0)
                counted[name] = at + 1
                found.setdefault((name,), number)
                table = (name, at)
            else:
                table = (name,)
            found.setdefault(table, number)
        elif key := _KEY.match(line):
            found.setdefault((*table, key[1]), number)
    return found
