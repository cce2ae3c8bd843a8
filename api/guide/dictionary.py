"""The data dictionary: every table that the project gives away, and what its columns hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.deposit import errors
from api.deposit.deposit_tables import measured_tables
from api.docs.markdown import table
from benchmark.results.store import PUBLISHED
from survey_data.descriptor import descriptor

Row = Mapping[str, Any]


def facts() -> str:
    """Describe the survey's tables, from their descriptor."""
    return "\n\n".join(
        _table(one["name"], one["path"], one["title"], one["description"], one["schema"])
        for one in descriptor()["resources"]
    )


def measurements() -> str:
    """Describe the measured tables, as the deposit brings them."""
    tables = [
        _table(one.name, f"{one.name}.csv", one.title, one.description, one.schema)
        for one in measured_tables(PUBLISHED)
    ]
    samples = [
        _table(name, path, title, "Parquet.", schema)
        for name, (path, title, schema) in errors.KINDS.items()
    ]
    return "\n\n".join([*tables, *samples])


def _table(name: str, path: str, title: str, description: str, schema: Row) -> str:
    fields = schema["fields"]
    rows = [
        (f"`{one['name']}`", _type(one), _needs(one), one.get("description", "")) for one in fields
    ]
    said = [f"### {name}", f"{title}: `{path}`. {description}"]
    key = _keys(schema)
    said += [key] if key else []
    return "\n\n".join([*said, table(("column", "type", "may be", "what it holds"), rows)])


def _type(field: Row) -> str:
    return str(field.get("type", "any"))


def _needs(field: Row) -> str:
    """Say in words what values are allowed."""
    bounds: Row = field.get("constraints", {})
    said = [] if bounds.get("required") else ["empty"]
    if "enum" in bounds:
        said.append(", ".join(f"`{value}`" for value in bounds["enum"]))
    if "minimum" in bounds or "maximum" in bounds:
        said.append(f"{bounds.get('minimum', '')} to {bounds.get('maximum', '')}".strip())
    if "pattern" in bounds:
        said.append(f"`{bounds['pattern']}`")
    return "; ".join(said)


def _keys(schema: Row) -> str:
    keys: Sequence[str] = schema.get("primaryKey") or next(iter(schema.get("uniqueKeys", ())), ())
    said = [f"A row is named by {_columns(keys)}."] if keys else []
    for foreign in schema.get("foreignKeys", ()):
        reference = foreign["reference"]
        target = reference.get("resource") or "this table"
        said.append(
            f"{_columns(foreign['fields'])} stands in "
            f"{f'[{target}](#{target})' if target != 'this table' else target} "
            f"({_columns(reference['fields'])})."
        )
    return " ".join(said)


def _columns(names: str | Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in ([names] if isinstance(names, str) else names))
