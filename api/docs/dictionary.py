"""The data dictionary: every table that the project gives away, and what its columns hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from api.deposit.deposit_tables import measured_tables
from api.metadata import errors
from benchmark.results.store import PUBLISHED
from survey_data.descriptor import descriptor

Row = Mapping[str, Any]
#: Name, path, title, description and schema of a table.
_Described = tuple[str, str, str, str, Row]

#: Values of a column that are listed; of more, their number is said.
LISTED = 8


def facts() -> str:
    """Describe the survey's tables, from their descriptor."""
    return _tables(
        (one["name"], one["path"], one["title"], one["description"], one["schema"])
        for one in descriptor()["resources"]
    )


def measurements() -> str:
    """Describe the measured tables, as the deposit brings them."""
    tables = [
        (one.name, f"{one.name}.csv", one.title, one.description, one.schema)
        for one in measured_tables(PUBLISHED)
    ]
    samples = [
        (name, path, title, "Parquet.", schema)
        for name, (path, title, schema) in errors.KINDS.items()
    ]
    return _tables([*tables, *samples])


def _tables(described: Iterable[_Described]) -> str:
    """Describe tables; a column that an earlier table describes in the same words is only named."""
    known: dict[tuple[str, str], str] = {}
    return "\n\n".join(_table(known, one) for one in described)


def _table(known: dict[tuple[str, str], str], table_of: _Described) -> str:
    name, path, title, description, schema = table_of
    lines, above = [], []
    for field in schema["fields"]:
        column, holds = field["name"], field.get("description", "")
        first = known.setdefault((column, holds), name)
        if first == name:
            lines.append(f"- `{column}` ({_type(field)}): {holds}{_allowed(field)}")
        else:
            above.append(f"`{column}` ([{first}](#{first}))")
    said = [f"### {name}", f"{title}: `{path}`. {description}"]
    key = _keys(schema)
    said += [key] if key else []
    said += ["\n".join(lines)] if lines else []
    said += [f"Columns described under the table in brackets: {', '.join(above)}."] if above else []
    return "\n\n".join(said)


def _type(field: Row) -> str:
    """Name the type, with a question mark where a cell may be empty."""
    needed = field.get("constraints", {}).get("required")
    return f"{field.get('type', 'any')}{'' if needed else '?'}"


def _allowed(field: Row) -> str:
    """Say in words what values are allowed; long lists and patterns are in the descriptor."""
    bounds: Row = field.get("constraints", {})
    values = bounds.get("enum", ())
    said = []
    if 0 < len(values) <= LISTED:
        said.append(", ".join(f"`{value}`" for value in values))
    elif values:
        said.append(f"one of {len(values)} values")
    if "minimum" in bounds and "maximum" in bounds:
        said.append(f"{bounds['minimum']} to {bounds['maximum']}")
    elif "minimum" in bounds or "maximum" in bounds:
        side = "minimum" if "minimum" in bounds else "maximum"
        said.append(f"at {'least' if side == 'minimum' else 'most'} {bounds[side]}")
    return f" ({'; '.join(said)})" if said else ""


def _keys(schema: Row) -> str:
    keys: Sequence[str] = schema.get("primaryKey") or next(iter(schema.get("uniqueKeys", ())), ())
    said = [f"Key: {_columns(keys)}."] if keys else []
    for foreign in schema.get("foreignKeys", ()):
        reference = foreign["reference"]
        target = reference.get("resource") or "this table"
        links = f"[{target}](#{target})" if target != "this table" else target
        said.append(f"{_columns(foreign['fields'])}: a row of {links}.")
    return " ".join(said)


def _columns(names: str | Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in ([names] if isinstance(names, str) else names))
