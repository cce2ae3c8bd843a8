"""The rules a Data Package descriptor cannot say, of the tables that commands change.

Each rule reads typed frames (row i of a frame stands in row i + 2 of its file) and runs only
where every table it needs could be read. What holds of the others, which are frozen, is tested
(`tests/survey_data/test_frozen_tables.py`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

import pandas as pd

from survey_data.accuracy_classes import class_disagreements
from survey_data.descriptor import primary_key
from survey_data.findings.grammar import Vocabulary
from survey_data.importing.values import states_nothing
from survey_data.nearest import one_of
from survey_data.problems import Problem
from survey_data.reported import KIND_OF
from survey_data.tables import FIRST_ROW
from survey_data.validation import citations, provenance
from survey_data.validation.cells import Frames, Rule, known_values, problem, texts
from survey_data.validation.extension import check_extension


def check_rules(frames: Frames) -> list[Problem]:
    """Return the problems every rule finds whose tables are all in `frames`."""
    rules = (*_RULES, *provenance.RULES, *citations.RULES)
    ours = [
        found
        for needed, rule in rules
        if all(table in frames for table in needed)
        for found in rule(frames)
    ]
    return ours + check_extension(frames, rules)


def _values_belong(frames: Frames) -> Iterator[Problem]:
    """Check that a value is of its attribute's vocabulary, or a number in its range."""
    vocabulary = Vocabulary(frames["taxonomy"]).values
    kinds = [kind for _, (kind,) in texts(frames["statistics"], "kind")]
    rows = frames["attribute_definitions"].to_dict("records")
    definitions = {str(row["attribute"]): row for row in rows}
    for index, (attribute, value) in texts(frames["attributes"], "attribute", "value"):
        if not value or attribute not in definitions:
            continue
        definition = definitions[attribute]
        if definition["kind"] != "numeric":
            categorical = definition["kind"] == "categorical"
            if value not in (vocabulary.get(attribute, ()) if categorical else kinds):
                of = "taxonomy value" if categorical else "kind"
                message = f"unknown {of} {value!r} of {attribute}"
                words = kinds if not categorical else _words(frames, attribute)
                if states_nothing(value):
                    hint = f"{one_of('', words)}; what is not stated has the basis unknown"
                else:
                    hint = one_of(value, words, _spellings(frames, attribute))
                yield problem("attributes", index, "value", f"{message}: {hint}")
            continue
        fault = number_fault(value, definition["min"], definition["max"])
        if fault is not None:
            yield problem("attributes", index, "value", f"{attribute}: {fault}")


def _words(frames: Frames, attribute: str) -> list[str]:
    """Return the values of an attribute in the order of the taxonomy."""
    cells = texts(frames["taxonomy"], "attribute", "value")
    return [value for _, (of, value) in cells if of == attribute]


def _spellings(frames: Frames, attribute: str) -> Iterator[tuple[str, str]]:
    """Give the other names of an attribute's values, each with its value."""
    for table, column in (("aliases", "alias"), ("taxonomy", "name")):
        if table in frames:
            for _, (of, name, value) in texts(frames[table], "attribute", column, "value"):
                if of == attribute:
                    yield name, value


def number_fault(text: str, least: float, most: float) -> str | None:
    """Say why a text is no number between two limits; None where it is."""
    if not re.fullmatch(r"[0-9]+(\.[0-9]+)?(e-?[0-9]{1,2})?", text):
        return f"expected a number, got {text!r}"
    number = float(text)
    if not math.isfinite(number) or not least <= number <= most:
        return f"expected a number from {least:g} to {most:g}, got {text}"
    return None


def _one_basis_a_cell(frames: Frames) -> Iterator[Problem]:
    """Check that a (study, attribute, value) stands once, with one basis."""
    seen: dict[tuple[str, ...], tuple[int, str]] = {}
    columns = ("study", "attribute", "value", "basis")
    for index, (*cell, basis) in texts(frames["attributes"], *columns):
        first = seen.setdefault(tuple(cell), (index, basis))
        if first[0] == index:
            continue
        row = first[0] + FIRST_ROW
        if basis == first[1]:
            message = f"duplicate row: {', '.join(cell)} stands already in row {row}"
            yield problem("attributes", index, "value", message)
        else:
            message = f"two bases for {', '.join(cell)}: {first[1]} in row {row} and {basis}"
            yield problem("attributes", index, "basis", message)


def _unknown_is_empty(frames: Frames) -> Iterator[Problem]:
    """Check that an empty value and the basis unknown go together, alone in their cell."""
    known: dict[tuple[str, str], int] = {}
    unknown: dict[tuple[str, str], int] = {}
    columns = ("study", "attribute", "value", "basis")
    for index, (study, attribute, value, basis) in texts(frames["attributes"], *columns):
        if basis == "unknown" and value:
            yield problem("attributes", index, "value", f"basis unknown, yet value {value!r}")
        elif not value and basis != "unknown":
            message = f"the value is empty, so the basis must be unknown, not {basis!r}"
            yield problem("attributes", index, "basis", message)
        (known if value else unknown).setdefault((study, attribute), index)
    for cell, index in unknown.items():
        if cell in known:
            message = f"unknown beside a value in row {known[cell] + FIRST_ROW}"
            yield problem("attributes", index, "value", message)


def _studies_are_complete(frames: Frames) -> Iterator[Problem]:
    """Check that every study has a row for every attribute, and one where one is admitted."""
    definitions = frames["attribute_definitions"]
    held: dict[tuple[str, str], list[int]] = {}
    for index, cell in texts(frames["attributes"], "study", "attribute"):
        held.setdefault((cell[0], cell[1]), []).append(index)
    for definition in definitions.to_dict("records"):
        attribute, complete = str(definition["attribute"]), definition["complete"]
        single = not pd.isna(definition["multiple"]) and not definition["multiple"]
        for index, (key,) in texts(frames["studies"], "key"):
            rows = held.get((key, attribute), [])
            if not pd.isna(complete) and complete and not rows:
                message = f"{key} has no row for the attribute {attribute} in attributes.csv"
                yield problem("studies", index, "key", message)
            if single and len(rows) > 1:
                message = f"{key} has several values of {attribute}, which admits one"
                yield problem("attributes", rows[1], "value", message)


def _printed_cells_agree(frames: Frames) -> Iterator[Problem]:
    """Check that basis survey-table and the printed tables say the same."""
    meant: dict[tuple[str, str], set[str]] = {}
    for _, (attribute, alias, value, origin) in texts(
        frames["aliases"], "attribute", "alias", "value", "origin"
    ):
        if origin == "survey":
            meant.setdefault((attribute, alias), set()).add(value)
    columns = ("study", "attribute", "value", "basis")
    ours: dict[tuple[str, str, str], int] = {}
    held: set[tuple[str, str, str]] = set()
    for index, (study, attribute, value, basis) in texts(frames["attributes"], *columns):
        held.add((study, attribute, value))
        if basis == "survey-table":
            ours[study, attribute, value] = index
    backed: set[tuple[str, str, str]] = set()
    for index, (study, attribute, label) in texts(
        frames["study_tables"], "study", "attribute", "value"
    ):
        same = {label} | meant.get((attribute, label), set())
        kinds = {value for value in same if value.startswith(f"{label}/")}
        cells = {(study, attribute, value) for value in same - kinds} & ours.keys()
        backed |= cells
        # The tables print parents alone: which kind it is rests on something else.
        if not cells and not {(study, attribute, kind) for kind in kinds} & held:
            message = f"{study} is printed under {label!r}, but attributes.csv does not carry it"
            yield problem("study_tables", index, "value", message)
    for cell, index in ours.items():
        if cell not in backed:
            message = f"basis survey-table, but study_tables.csv has no such cell: {cell}"
            yield problem("attributes", index, "value", message)


def _years_match_keys(frames: Frames) -> Iterator[Problem]:
    """Check that the year is the one in the key, and an unidentified study has no title."""
    for index, (key, year, title, identity) in texts(
        frames["studies"], "key", "year", "title", "identity"
    ):
        digits = re.search(r"[0-9]{4}", key)
        if digits is not None and year != digits.group():
            message = f"the key {key} says {digits.group()}, got {year!r}"
            yield problem("studies", index, "year", message)
        if identity == "unknown" and title:
            yield problem("studies", index, "title", "identity unknown, yet a title")
        if identity == "confirmed" and not title:
            yield problem("studies", index, "title", "identity confirmed, yet no title")


def _classes_keep_their_limits(frames: Frames) -> Iterator[Problem]:
    """Check a class against its study's number, where neither is printed by the survey."""
    found = class_disagreements(frames["taxonomy"], frames["attributes"])
    for index, one in found:
        if not one.printed:
            message = (
                f"{one.study} is filed as {one.filed}, but by the limits of taxonomy.csv its "
                f"{one.accuracy_deg:g} deg are {one.by_limits}"
            )
            yield problem("attributes", index, "value", message)


def _kinds_have_a_number(frames: Frames) -> Iterator[Problem]:
    """Check that a kind of accuracy or precision stands beside a number of the study."""
    known = known_values(frames)
    number_of = {kind: number for number, kind in KIND_OF.items()}
    for index, (study, attribute, value) in texts(
        frames["attributes"], "study", "attribute", "value"
    ):
        number = number_of.get(attribute)
        if value and number is not None and (study, number) not in known:
            message = f"{study} has a kind and no {number}"
            yield problem("attributes", index, "attribute", message)


def count_rows(frame: pd.DataFrame, column: str, value: str) -> int:
    """Count a frame's rows, or those with a value (as text) in a column."""
    if not column:
        return len(frame)
    return sum(cell == value for _, (cell,) in texts(frame, column))


def _counts_hold(frames: Frames) -> Iterator[Problem]:
    """Check that every table holds as many rows as counts.csv says."""
    names = ("table", "column", "value", "held")
    for index, (table, column, value, held) in texts(frames["counts"], *names):
        if table not in frames:
            continue
        if column and column not in frames[table].columns:
            yield problem("counts", index, "column", f"{table} has no column {column!r}")
            continue
        found = count_rows(frames[table], column, value)
        if str(found) != held:
            what = f"rows with {column} = {value!r}" if column else "rows"
            message = (
                f"a row is missing or too many: {found} {what}, "
                f"counts.csv (row {index + FIRST_ROW}) says {held}"
            )
            yield problem(table, len(frames[table]), column or primary_key(table)[0], message)


_RULES: tuple[tuple[tuple[str, ...], Rule], ...] = (
    (("attributes", "taxonomy", "attribute_definitions", "statistics"), _values_belong),
    (("attributes",), _one_basis_a_cell),
    (("attributes",), _unknown_is_empty),
    (("studies", "attributes", "attribute_definitions"), _studies_are_complete),
    (("attributes", "study_tables", "aliases"), _printed_cells_agree),
    (("studies",), _years_match_keys),
    (("taxonomy", "attributes"), _classes_keep_their_limits),
    (("attributes",), _kinds_have_a_number),
    (("counts",), _counts_hold),
)
