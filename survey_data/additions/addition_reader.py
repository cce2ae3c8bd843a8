"""Reading the template of a study into rows of the tables, with every fault by its line."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from survey_data.additions.faults import Fault, FaultsError, one_of
from survey_data.additions.toml_lines import TomlDocument
from survey_data.additions.vocabulary import Definition, Vocabulary
from survey_data.descriptor import column_types
from survey_data.importing.bibliography import TURNING
from survey_data.importing.values import states_nothing
from survey_data.sources import fault as source_fault
from survey_data.validation.provenance import TOLD
from survey_data.validation.rules import number_fault

Row = Mapping[str, str]

_LONGEST = 5000
_CONTROL = re.compile(
    rf"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x85\u2028\u2029\ud800-\udfff\ufffd{TURNING}]"
)
_RESOLVER = re.compile(r"^(?:https?://(?:dx\.)?doi\.org/|doi:\s*)", re.IGNORECASE)
#: Keys of a value beside the columns of its row.
_BESIDE = ("name", "nearest", "role", "role_note")
_ARCHITECTURE = "architecture"
_FLAG = "nearest"
#: Note of a role whose file says nothing of why; the table of roles has one in every row.
_NO_REASON = "No reason stated."
METHODS = ("model", "extractor")


@dataclass(frozen=True)
class Addition:
    """A study as rows of the extension's tables, by table without its prefix (``studies``...)."""

    key: str
    rows: Mapping[str, tuple[Row, ...]]

    @property
    def study(self) -> Row:
        """The row of the study itself."""
        return self.rows["studies"][0]


@dataclass
class _Reader:
    """Reads one document, noting every fault."""

    document: TomlDocument
    vocabulary: Vocabulary
    faults: list[Fault] = field(default_factory=list)

    def fault(self, message: str, *place: str | int) -> None:
        self.faults.append(Fault(self.document.line(*place), message))

    def text(self, value: object, *place: str | int) -> str:
        """Return a cell's text; '' with a fault where it is none."""
        name = str(place[-1])
        if isinstance(value, bool) or not isinstance(value, str | int | float):
            self.fault(f"{name}: expected a text, got {json.dumps(value, default=str)}", *place)
            return ""
        said = repr(value) if isinstance(value, float) else str(value)
        if found := _CONTROL.search(said):
            self.fault(f"{name}: holds the character U+{ord(found[0]):04X}", *place)
            return ""
        said = " ".join(said.split())
        if len(said) > _LONGEST:
            self.fault(f"{name}: longer than {_LONGEST} characters", *place)
            return ""
        return said

    def tables(self, name: str) -> Sequence[Mapping[str, object]]:
        """Return the tables of a name; none, with a fault, where something else stands there."""
        given = self.document.values.get(name, [])
        if isinstance(given, list) and all(isinstance(each, dict) for each in given):
            return given
        self.fault(f"{name}: expected tables [[{name}]], one a value", name)
        return ()

    def cells(
        self, table: Mapping[str, object], columns: Sequence[str], *place: str | int
    ) -> dict[str, str]:
        """Return the texts of a table, '' where it says nothing."""
        return {c: self.text(table[c], *place, c) if c in table else "" for c in columns}

    def word(self, value: str, words: Sequence[str], *place: str | int) -> None:
        """Note a fault where a word is not among those allowed."""
        if value not in words:
            self.fault(f"{place[-1]} {value!r}: {one_of(value, words)}", *place)

    def keys(self, given: Mapping[str, object], known: Sequence[str], *place: str | int) -> None:
        """Note a fault for each key that means nothing."""
        for key in given:
            if key not in known:
                self.fault(f"unknown key {key!r}: {one_of(key, known)}", *place, key)


def read_addition(
    document: TomlDocument, vocabulary: Vocabulary, publication: Row | None = None
) -> Addition:
    """Read a template.

    Parameters
    ----------
    document : the TOML
    vocabulary : what its words may be
    publication : what a bibliography says of the study; the template's own words go before

    Raises
    ------
    FaultsError
        Names every fault with its line.
    """
    reader = _Reader(document, vocabulary)
    values = document.values
    columns = list(column_types("extension_studies"))
    attributes = list(vocabulary.definitions)
    reader.keys(values, [*columns, *attributes, _ARCHITECTURE])
    study = _study(reader, columns, publication or {})
    key = study["key"]
    rows: dict[str, list[Row]] = {"studies": [study], "roles": [], "names": []}
    rows["attributes"] = []
    for definition in vocabulary.definitions.values():
        for name, row in _values(reader, key, definition):
            rows[name].append(row)
    rows["architectures"] = list(_architectures(reader, key, rows["attributes"]))
    if reader.faults:
        raise FaultsError(document.name, reader.faults)
    return Addition(key, {name: tuple(found) for name, found in rows.items()})


def _study(reader: _Reader, columns: Sequence[str], publication: Row) -> dict[str, str]:
    given = reader.document.values
    stated = {column: publication.get(column, "") for column in columns if column not in given}
    found = {column: reader.text(said, column) for column, said in stated.items()}
    found = {column: found.get(column, "") for column in columns}
    for column in columns:
        if column == "authors" and isinstance(given.get(column), list):
            found[column] = _authors(reader, given[column])
        elif column in given:
            found[column] = reader.text(given[column], column)
    found["doi"] = _RESOLVER.sub("", found["doi"])
    for column in ("key", "title", "year", "type", "identity"):
        if not found[column]:
            reader.fault(f"{column}: expected a value, got none", column)
    if not (found["doi"] or found["url"]):
        reader.fault("doi, url: expected one of the two at least, got none", "doi")
    _check_study(reader, found)
    return found


def _authors(reader: _Reader, given: Sequence[object]) -> str:
    names = [reader.text(name, "authors") for name in given]
    if any(";" in name for name in names):
        reader.fault("authors: a name holds a semicolon, which divides names", "authors")
    return "; ".join(name for name in names if name)


def _check_study(reader: _Reader, found: Mapping[str, str]) -> None:
    """Note what is wrong with the publication."""
    known = reader.vocabulary
    for column, words in known.words.items():
        if found.get(column):
            reader.word(found[column], words, column)
    for column, pattern in known.patterns.items():
        if found.get(column) and not re.search(pattern, found[column]):
            form = known.forms.get(column, pattern)
            reader.fault(f"{column}: expected {form}, got {found[column]!r}", column)
    if wrong := source_fault(found["url"], known.hosts):
        reader.fault(f"url: {wrong}", "url")
    for column in ("key", "doi"):
        if taken := known.used_names.get(found[column].casefold()):
            reader.fault(f"{column} {found[column]}: {taken}", column)
    _year(reader, found)


def _year(reader: _Reader, found: Mapping[str, str]) -> None:
    year, key = found["year"], found["key"]
    least, most = reader.vocabulary.years
    if year and not (re.fullmatch(r"[0-9]{4}", year) and least <= int(year) <= most):
        reader.fault(f"year: expected a year from {least} to {most}, got {year!r}", "year")
    elif year and key and (digits := re.search(r"[0-9]{4}", key)) and digits[0] != year:
        reader.fault(f"year {year}: the key {key} says {digits[0]}", "year")


def _values(reader: _Reader, key: str, definition: Definition) -> Iterator[tuple[str, Row]]:
    """Give the rows that an attribute makes, each with its table."""
    name = definition.attribute
    own = [c for c in column_types("extension_attributes") if c not in ("study", "attribute")]
    given = reader.tables(name)
    seen: set[str] = set()
    for at, table in enumerate(given):
        reader.keys(table, [*own, *_BESIDE], name, at)
        cells = reader.cells(table, own, name, at)
        _check_value(reader, definition, cells, at)
        _check_evidence(reader, name, cells, at)
        if cells["value"] in seen:
            reader.fault(f"{name} {cells['value']!r}: stands twice", name, at, "value")
        seen.add(cells["value"])
        row = {"study": key, "attribute": name, **cells}
        yield "attributes", row
        yield from _name_of(reader, row, table, at)
        yield from _role(reader, row, table, at)
    if "" in seen and len(seen) > 1:
        reader.fault(f"{name}: unknown beside a value", name)
    if len(given) > 1 and not definition.multiple:
        reader.fault(f"{name}: one value at most, got {len(given)}", name, 1)
    if not given and definition.complete:
        empty = {**dict.fromkeys(own, ""), "basis": "unknown"}
        yield "attributes", {"study": key, "attribute": name, **empty}


def _check_value(reader: _Reader, definition: Definition, cells: Row, at: int) -> None:
    """Note where a value is none of its attribute's."""
    name, value = definition.attribute, cells["value"]
    message = ""
    if cells["basis"] == "unknown":
        message = f"{name} {value!r}: basis unknown, yet a value" if value else ""
    elif not value:
        message = f"{name}: expected a value, or the basis unknown"
    elif definition.words:
        if value not in definition.words:
            near = reader.vocabulary.spellings.get(name, ())
            message = f"{name} {value!r}: {one_of(value, definition.words, near)}"
            if states_nothing(value):
                listed = one_of(value, definition.words, guess=False)
                message = f"{name} {value!r}: {listed}; what is not stated has the basis unknown"
    elif wrong := number_fault(value, definition.minimum, definition.maximum):
        message = f"{name}: {wrong}"
    if message:
        reader.fault(message, name, at, "value")


def _check_evidence(reader: _Reader, name: str, cells: Row, at: int) -> None:
    """Note where a row does not say what it rests on."""
    basis, bases = cells["basis"], list(reader.vocabulary.bases)
    if not basis:
        reader.fault(f"{name}: expected a basis, got none", name, at, "basis")
        return
    reader.word(basis, bases, name, at, "basis")
    column = TOLD.get(basis, "")
    if column and not cells[column]:
        reader.fault(f"{name}: the basis {basis} needs a {column}", name, at, "basis")
    if wrong := source_fault(cells["source"], reader.vocabulary.hosts):
        reader.fault(f"source: {wrong}", name, at, "source")


def _name_of(
    reader: _Reader, row: Row, table: Mapping[str, object], at: int
) -> Iterator[tuple[str, Row]]:
    """Give the row of the value's name in the study."""
    attribute = row["attribute"]
    name = reader.cells(table, ("name",), attribute, at)["name"]
    flag = table.get(_FLAG, False)
    if not isinstance(flag, bool):
        reader.fault(f"{_FLAG}: expected true or false, got {flag!r}", attribute, at, _FLAG)
    elif flag and not name:
        message = f"{attribute} {row['value']!r}: {_FLAG} = true needs a name"
        reader.fault(message, attribute, at, _FLAG)
    if not name:
        return
    if not row["value"] or not reader.vocabulary.definitions[attribute].has_names:
        reader.fault("name: only of a value of the taxonomy", attribute, at, "name")
    of = {column: row[column] for column in ("study", "attribute", "value")}
    yield "names", {**of, "name": name, _FLAG: "true" if flag is True else "false"}


def _role(
    reader: _Reader, row: Row, table: Mapping[str, object], at: int
) -> Iterator[tuple[str, Row]]:
    """Give the row of a method's role."""
    attribute = row["attribute"]
    said = reader.cells(table, ("role", "role_note"), attribute, at)
    reason = said["role_note"] or row["note"] or _NO_REASON
    if not said["role"]:
        if said["role_note"]:
            reader.fault("role_note without a role", attribute, at, "role_note")
        return
    reader.word(said["role"], reader.vocabulary.roles, attribute, at, "role")
    if attribute not in METHODS or not row["value"]:
        reader.fault(f"role: only of a value of {' and '.join(METHODS)}", attribute, at, "role")
    of = {column: row[column] for column in ("study", "attribute", "value")}
    evidence = {"basis": row["basis"], "source": row["source"], "note": reason}
    yield "roles", {**of, "role": said["role"], **evidence}


def _architectures(reader: _Reader, key: str, values: Sequence[Row]) -> Iterator[Row]:
    """Give the rows of the sensors that are listed."""
    own = [column for column in column_types("extension_architectures") if column != "study"]
    known: dict[str, list[str]] = {}
    for row in values:
        known.setdefault(row["attribute"], []).append(row["value"])
    unused = {part: set(known.get(part, ())) for part in ("detector", "mask")}
    given = reader.tables(_ARCHITECTURE)
    for at, table in enumerate(given):
        reader.keys(table, own, _ARCHITECTURE, at)
        cells = reader.cells(table, own, _ARCHITECTURE, at)
        for part, rest in unused.items():
            reader.word(cells[part], known.get(part, []), _ARCHITECTURE, at, part)
            rest.discard(cells[part])
        _check_evidence(reader, _ARCHITECTURE, cells, at)
        yield {"study": key, **cells}
    for part, rest in unused.items() if given else ():
        for value in sorted(rest):
            reader.fault(f"{part} {value!r} is on none of the sensors listed", _ARCHITECTURE)
