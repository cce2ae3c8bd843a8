"""Reading the template of a study into rows of the tables, with every fault by its line."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    StrictBool,
    ValidationError,
    ValidationInfo,
    field_validator,
)

from files.reading import parse_toml as toml_of
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name
from survey_data.importing.bibliography import FORBIDDEN
from survey_data.importing.writing import offered_text
from survey_data.json_data import JsonData
from survey_data.nearest import one_of
from survey_data.problems import SurveyImportError
from survey_data.table_records import Records, read_table_records
from survey_data.validation.extension import SHARED
from survey_data.validation.validate import check_records

Row: TypeAlias = Mapping[str, str]
Place: TypeAlias = tuple[str | int, ...]
"""Keys and positions that lead to a value, such as ``("model", 0, "basis")``."""

#: Bytes of a file, and its keys, values of a list and tables: each may be a fault, with its words.
_MOST_BYTES, _MOST_KEYS = 1_000_000, 2000
_LONGEST, _LARGEST = 5000, 1e15
_RESOLVER = re.compile(r"^(?:https?://(?:dx\.)?doi\.org/|doi:\s*)", re.IGNORECASE)
#: Note of a role whose file says nothing of why; the table of roles has one in every row.
_NO_REASON = "No reason stated."
_TABLE = re.compile(r"\s*\[(\[)?\s*\"?([\w-]+)\"?\s*\]")
_KEY = re.compile(r"\s*([\w-]+)\s*=")
_LONG_STRING = re.compile(r'""".*?"""|\'\'\'.*?\'\'\'', re.DOTALL)
_SYNTAX = re.compile(r"^(.*) \(at (?:line (\d+), column \d+|(end of document))\)$", re.DOTALL)


@dataclass(frozen=True)
class Fault(JsonData):
    """One fault; ``line`` is None where no line is at fault."""

    line: int | None
    message: str


class FaultsError(SurveyImportError):
    """A file cannot be taken, for these faults; nothing has been written."""

    def __init__(self, file: str, faults: Sequence[Fault]) -> None:
        self.file = file
        self.faults = tuple(sorted(faults, key=lambda fault: fault.line or 0))
        super().__init__("\n".join(self.lines))

    @property
    def lines(self) -> list[str]:
        """A line for each fault: file, line, what was expected."""
        return [
            f"{self.file}{'' if each.line is None else f', line {each.line}'}: {each.message}"
            for each in self.faults
        ]


@dataclass(frozen=True)
class TomlDocument:
    """Values of a TOML file, and the line on which each table and key starts."""

    name: str
    values: Mapping[str, Any]
    lines: Mapping[Place, int]

    def line(self, place: Place) -> int:
        """Return the line of a value, or of the nearest thing around it that has one."""
        ends = range(len(place), 0, -1)
        return next((self.lines[place[:end]] for end in ends if place[:end] in self.lines), 1)


def read_toml(path: Path) -> TomlDocument:
    """Read a TOML file; SurveyImportError says where it cannot be read, or is no TOML."""
    return parse_toml(offered_text(path, _MOST_BYTES), path.name)


def parse_toml(text: str, name: str) -> TomlDocument:
    """Read the text of a TOML file; raises as `read_toml` does."""
    text = text.replace("\r\n", "\n")
    try:
        return TomlDocument(name, toml_of(text), _lines(text))
    except ValueError as error:  # tomllib's own, and a number of too many digits
        said = _SYNTAX.match(str(error))
        line = None if said is None else int(said[2] or text.count("\n") + 1)
        message = f"no valid TOML: {said[1] if said else error}"
        raise FaultsError(name, [Fault(line, message)]) from error
    except RecursionError as error:
        raise FaultsError(name, [Fault(None, "nested too deeply")]) from error


def _lines(text: str) -> dict[Place, int]:
    found: dict[Place, int] = {}
    counted: Counter[str] = Counter()
    table: Place = ()
    short = _LONG_STRING.sub(lambda string: "\n" * string[0].count("\n"), text)
    for number, line in enumerate(short.split("\n"), start=1):
        if opened := _TABLE.match(line):
            name = opened[2]
            table = (name, counted[name]) if opened[1] else (name,)
            counted[name] += 1
            found.setdefault((name,), number)
            found.setdefault(table, number)
        elif key := _KEY.match(line):
            found.setdefault((*table, key[1]), number)
    return found


def _text(value: object) -> str:
    if not isinstance(value, str):
        message = f"expected a text, got {json.dumps(value, default=str):.60}"
        raise ValueError(message)  # noqa: TRY004 - pydantic's
    if found := FORBIDDEN.search(value):
        raise ValueError(f"holds the character U+{ord(found[0]):04X}")
    if len(value) > _LONGEST:
        raise ValueError(f"longer than {_LONGEST} characters")
    return " ".join(value.split())


def _text_or_number(value: object) -> str:
    if isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < _LARGEST:
        return repr(value)
    return _text(value)


Text: TypeAlias = Annotated[str, BeforeValidator(_text)]
TextOrNumber: TypeAlias = Annotated[str, BeforeValidator(_text_or_number)]


class Evidence(BaseModel):
    """What a table of a template rests on."""

    model_config = ConfigDict(extra="forbid")

    basis: Text = ""
    source: Text = ""
    note: Text = ""


class Value(Evidence):
    """A value of an attribute, what the study calls it, and the role of a method."""

    value: TextOrNumber = ""
    name: Text = ""
    nearest: StrictBool = False
    role: Text = ""
    role_note: Text = ""

    @field_validator("nearest", "role_note")
    @classmethod
    def _goes_with_another(cls, said: bool | str, info: ValidationInfo) -> bool | str:
        needed = {"nearest": "name", "role_note": "role"}[info.field_name or ""]
        if said and not info.data.get(needed):
            raise ValueError(f"needs a {needed}")
        return said


class Sensor(Evidence):
    """A detector and a mask that go together."""

    detector: Text = ""
    mask: Text = ""


class OfferedStudy(BaseModel):
    """A template: the publication, and tables of values by attribute."""

    model_config = ConfigDict(extra="allow", validate_default=True)
    __pydantic_extra__: dict[str, list[Value]]

    key: Text = ""
    title: Text = ""
    authors: Text = ""
    year: TextOrNumber = ""
    venue: Text = ""
    type: Text = ""
    doi: Text = ""
    url: Text = ""
    identity: Text = ""
    note: Text = ""
    architecture: list[Sensor] = []

    @field_validator("authors", mode="before")
    @classmethod
    def _join(cls, given: object) -> object:
        names = [_text(name) for name in given] if isinstance(given, list) else []
        if any(";" in name for name in names):
            raise ValueError("a name holds a semicolon, which divides names")
        return "; ".join(filter(None, names)) if isinstance(given, list) else given

    @field_validator("key")
    @classmethod
    def _is_stated(cls, said: str) -> str:
        if not said:
            raise ValueError("expected a value, got none")
        return said

    @field_validator("doi")
    @classmethod
    def _without_resolver(cls, doi: str) -> str:
        return _RESOLVER.sub("", doi)


@dataclass(frozen=True)
class Addition:
    """A study as rows of the extension's tables, by table without its prefix (``studies``...)."""

    key: str
    rows: Mapping[str, tuple[Row, ...]]

    @property
    def study(self) -> Row:
        """The row of the study itself."""
        return self.rows["studies"][0]


def read_addition(document: TomlDocument, directory: Path = DATA_DIRECTORY) -> Addition:
    """Read a template, by the rules of our tables, whose keys are taken.

    Raises
    ------
    FaultsError
        Names every fault with its line: those of the form, or else those of the content; of a
        file with more keys than a study may have that alone.
    """
    lists = [each for each in document.values.values() if isinstance(each, list)]
    inner = [1 + (len(one) if isinstance(one, dict) else 0) for each in lists for one in each]
    if (keys := len(document.values) + sum(inner)) > _MOST_KEYS:
        message = f"expected at most {_MOST_KEYS} keys, tables and names; got {keys}"
        raise FaultsError(document.name, [Fault(None, message)])
    rows = read_table_records(directory, "attribute_definitions").rows
    complete = {cells[0]: cells[4] == "true" for _, cells in rows}
    faults = []
    for name in document.values:
        known = [*OfferedStudy.model_fields, *complete]
        if name not in known:
            message = f"unknown key {name!r:.60}: {one_of(name, known)}"
            faults.append(Fault(document.line((name,)), message))
    values = {name: each for name, each in document.values.items() if name in known}
    try:
        study = OfferedStudy.model_validate(values)
    except ValidationError as error:
        faults += [_fault(document, dict(each)) for each in error.errors(include_url=False)]
    if faults:
        raise FaultsError(document.name, faults)
    addition, places = _rows(study, complete)
    if faults := _broken_rules(document, directory, addition, places):
        raise FaultsError(document.name, faults)
    return addition


def _fault(document: TomlDocument, error: Mapping[str, Any]) -> Fault:
    place, kind = error["loc"], error["type"]
    message = f"{place[-1]}: {error.get('ctx', {}).get('error', error['msg'])}"
    if kind == "extra_forbidden":
        model = Sensor if place[0] == "architecture" else Value
        message = f"unknown key {place[-1]!r:.60}: {one_of(place[-1], model.model_fields)}"
    elif kind in ("list_type", "model_type"):
        message = f"{place[0]}: expected tables [[{place[0]}]], one a value"
    elif kind == "bool_type":
        message = f"{place[-1]}: expected true or false, got {error['input']!r}"
    return Fault(document.line(place), message)


def _rows(
    study: OfferedStudy, complete: Mapping[str, bool]
) -> tuple[Addition, dict[str, list[Place]]]:
    """Return the rows that a template makes, and by table where in it each stands."""
    names = ("studies", "attributes", "roles", "names", "architectures")
    rows: dict[str, list[dict[str, str]]] = {name: [] for name in names}
    places: dict[str, list[Place]] = {name: [] for name in names}

    def add(table: str, said: Mapping[str, Any], *place: str | int) -> None:
        columns = column_types(f"extension_{table}")
        of_study = {**said, "study": study.key}
        rows[table].append({column: str(of_study.get(column, "")) for column in columns})
        places[table].append(place)

    add("studies", study.model_dump())
    for attribute, is_needed in complete.items():
        given = (study.model_extra or {}).get(attribute, [])
        for at, value in enumerate(given):
            said = {**value.model_dump(), "attribute": attribute}
            add("attributes", said, attribute, at)
            if value.name:
                add("names", {**said, "nearest": str(value.nearest).lower()}, attribute, at)
            if value.role:
                reason = value.role_note or value.note or _NO_REASON
                add("roles", {**said, "note": reason}, attribute, at)
        if not given and is_needed:
            add("attributes", {"attribute": attribute, "basis": "unknown"}, attribute)
    for at, sensor in enumerate(study.architecture):
        add("architectures", sensor.model_dump(), "architecture", at)
    return Addition(study.key, {name: tuple(each) for name, each in rows.items()}), places


def _broken_rules(
    document: TomlDocument, directory: Path, addition: Addition, places: Mapping[str, list[Place]]
) -> list[Fault]:
    """Return what the rules of the tables say of these rows."""
    tables = {
        name: read_table_records(directory, name) for name in (*SHARED, "studies", "references")
    }
    place_of: dict[tuple[str, int], Place] = {}
    for name, rows in addition.rows.items():
        table = f"extension_{name}"
        cells = [(at, list(row.values())) for at, row in enumerate(rows, start=2)]
        tables[table] = Records(list(column_types(table)), cells)
        place_of |= {(file_name(table), at + 2): place for at, place in enumerate(places[name])}
    faults: dict[tuple[int, str], Fault] = {}
    if not addition.study["title"]:
        line = document.line(("title",))
        faults[line, "title"] = Fault(line, "title: expected a value, got none")
    if not (addition.study["doi"] or addition.study["url"]):
        faults[1, "url"] = Fault(1, "url: expected a doi or a url, got neither")
    own = [table for table in tables if table.startswith("extension_")]
    for problem in check_records(tables, (*own, "bases")):
        place, column = place_of.get((problem.file, problem.row or 0)), problem.column or ""
        if place is None or column == "study":  # that is a fault of the key
            continue

        def other(row: re.Match[str], file: str = problem.file) -> str:
            return f"in line {document.line(place_of.get((file, int(row[1])), ()))}"

        message = re.sub(r"in row (\d+)", other, problem.message)
        label = str(place[0]) if place and column == "value" else column
        message = message if column == "value" and label in message else f"{label}: {message}"
        is_said = (*place, column) in document.lines
        at = document.line((*place, column if is_said else "basis"))
        faults.setdefault((at, label), Fault(at, message))
    return list(faults.values())
