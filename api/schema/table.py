"""Tables of a resource: the columns that its model implies, and rows as CSV.

The command line, the HTTP service, the deposit and its descriptors take the columns of a table from
here, so that their files agree byte for byte. A table has its columns whatever is asked: what a
question does not touch is an empty cell.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, TypeAlias, Union, get_args, get_origin

from pydantic import BaseModel

from api.cells import cell
from api.schema.vocabulary import MEANINGS, add_to_first_clause, meaning
from files.csv_writing import csv_text
from registry.taxonomy import taxonomy_rows

Row: TypeAlias = Mapping[str, Any]
Model: TypeAlias = type[BaseModel]
Type = Literal["string", "integer", "number", "boolean"]

_TYPES: Mapping[Any, Type] = {str: "string", int: "integer", float: "number", bool: "boolean"}


@dataclass(frozen=True)
class AsText:
    """A member that a table holds as a list of texts, whatever it is in JSON."""


@dataclass(frozen=True)
class ColumnEach:
    """A mapping of which each of these keys is a column by itself."""

    keys: tuple[str, ...]


AS_TEXT = AsText()


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    name
        In the header; a member of a nested model is called `outer_inner`.
    type
        Of its cells; "string" for lists, whose items are joined by "; ".
    description
        What it means, with its unit; empty where nothing says it.
    single
        Whether a cell holds one value, by which rows can be sorted.
    """

    name: str
    type: Type
    description: str
    single: bool


@cache
def described_columns(model: Model) -> Mapping[str, Column]:
    """Return the columns of a table of this model by name, in the order of its members.

    Members that hold lists of models, or mappings to anything but values, are in JSON alone.
    """
    return {column.name: column for column in _columns(model, "")}


@cache
def columns_of(model: Model) -> tuple[str, ...]:
    """Return the names of the columns, in order."""
    return tuple(described_columns(model))


def sortable(model: Model) -> tuple[str, ...]:
    """Return the names of columns whose cells hold one value each."""
    return tuple(name for name, column in described_columns(model).items() if column.single)


def flat(row: Row, names: Iterable[str]) -> dict[str, Any]:
    """Return the values of a row by column, in the table's order; None for what it lacks."""
    wanted = tuple(names)
    found = dict(_values(row, frozenset(wanted)))
    return {name: found.get(name) for name in wanted}


def csv_of(names: Iterable[str], rows: Iterable[Row]) -> str:
    """Return rows as CSV (RFC 4180, but lines end in a line feed alone, as files here do).

    Parameters
    ----------
    names : of the columns, in order; what rows have besides is left out
    rows : one mapping a row; a member of a nested mapping is the column `outer_inner`. Lists are
        joined by "; ", mappings that are a column themselves are JSON, nothing (None, NaN) is
        empty, and the taxonomy's "None" is spelled out (`registry.taxonomy.taxonomy_rows`)

    Returns
    -------
    str
        A header and a line a row.
    """
    header = tuple(names)
    made = (flat(row, header).items() for row in rows)
    return csv_text(header, ([cell(taxonomy_rows(*one)) for one in row] for row in made))


def _columns(model: Model, prefix: str) -> Iterator[Column]:
    for name, field in model.model_fields.items():
        column, said = prefix + name, meaning(name, field.description)
        spread = next((one for one in field.metadata if isinstance(one, ColumnEach)), None)
        if AS_TEXT in field.metadata:
            yield Column(column, "string", _list_of(said), single=False)
        elif spread is not None:
            yield from (Column(key, "string", _value_of(key), single=False) for key in spread.keys)
        else:
            yield from _of_type(column, _bare(field.annotation), said)


def _of_type(column: str, kind: Any, said: str) -> Iterator[Column]:
    origin, inner = get_origin(kind), [_bare(one) for one in get_args(kind)]
    if isinstance(kind, type) and issubclass(kind, BaseModel):
        yield from _columns(kind, f"{column}_")
    elif origin is list or (origin is dict and inner[1] in _TYPES):
        if _is_value(inner[-1]):
            yield Column(column, "string", _list_of(said) if origin is list else said, single=False)
    elif _is_value(kind):
        name = "string" if origin is Literal else _TYPES[kind]
        yield Column(column, name, said, single=True)


def _list_of(said: str) -> str:
    return said if "semicolon" in said else add_to_first_clause(said, ", separated by semicolons")


def _is_value(kind: Any) -> bool:
    return kind in _TYPES or get_origin(kind) is Literal


def _bare(kind: Any) -> Any:
    """Return a type without its annotations and without None."""
    if get_origin(kind) is Annotated:
        return _bare(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        kinds = [one for one in get_args(kind) if one is not NoneType]
        return _bare(kinds[0]) if len(kinds) == 1 else kind
    return kind


def _value_of(attribute: str) -> str:
    return MEANINGS.get(attribute, f"Values of the attribute {attribute}, separated by semicolons.")


def _values(row: Row, wanted: frozenset[str], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in row.items():
        column = prefix + name
        if column in wanted:
            yield column, value
        elif isinstance(value, Mapping):
            yield from _values(value, wanted, f"{column}_")
