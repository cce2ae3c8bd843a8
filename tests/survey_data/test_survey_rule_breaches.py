"""A cell that breaks a rule of the tables is named with its row, its column and the rule."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields

import pandas as pd
import pytest

import survey_data
from survey_data.descriptor import file_name
from survey_data.tables import FIRST_ROW
from survey_data.validation.cells import Frames
from survey_data.validation.rules import check_rules

#: Changes a frame; returns it with the place of the row that is at fault.
Change = Callable[[pd.DataFrame], tuple[pd.DataFrame, int]]
Where = Mapping[str, object]

#: Rules look at the frames they need, and at nothing where one is missing.
MODELS = ("taxonomy", "attributes", "compensated_models", "method_variants")
MODEL = {"study": "Alvi2014", "attribute": "model"}
NONE: Where = {}


@pytest.fixture(scope="module")
def frames(tables: survey_data.SurveyTables) -> dict[str, pd.DataFrame]:
    return {each.name: getattr(tables, each.name) for each in fields(tables)}


def place(frame: pd.DataFrame, where: Where) -> int:
    """Return the first row with these cells; a cell of None is a missing one."""
    chosen = pd.Series(True, index=frame.index)
    for column, value in where.items():
        chosen &= frame[column].isna() if value is None else frame[column] == value
    return int(frame.index[chosen][0])


def put(where: Where, **cells: str | float | None) -> Change:
    def change(frame: pd.DataFrame) -> tuple[pd.DataFrame, int]:
        at, changed = place(frame, where), frame.copy()
        for column, value in cells.items():
            changed.loc[at, column] = value
        return changed, at

    return change


def again(where: Where, **cells: str | None) -> Change:
    """Append a row like the one that is there, but for some cells."""

    def change(frame: pd.DataFrame) -> tuple[pd.DataFrame, int]:
        at = place(frame, where)
        added = frame.loc[[at]].assign(**cells).astype(frame.dtypes)
        return pd.concat([frame, added], ignore_index=True), len(frame)

    return change


def breaches(frames: Frames, table: str, change: Change) -> list[tuple[str, int, str, str]]:
    """Return file, row relative to the one at fault, column and message of each problem."""
    changed, at = change(frames[table])
    found = check_rules({**frames, table: changed})
    return [(p.file, (p.row or 0) - FIRST_ROW - at, str(p.column), p.message) for p in found]


@pytest.mark.parametrize(
    ("needed", "change", "column", "said"),
    [
        (("attributes",), again(MODEL), "value", "duplicate row: Alvi2014, model, "),
        (("attributes",), put({"basis": "unknown"}, value="Slit"), "value", "yet value 'Slit'"),
        (("attributes",), put({"basis": "title"}, value=None), "basis", "unknown, not 'title'"),
        (
            ("attributes",), again(MODEL, value=None, basis="unknown"), "value",
            "unknown beside a value in row ",
        ),
        (("studies",), put({"key": "Chang2008"}, identity="unknown"), "title", "yet a title"),
        (("studies",), put({"key": "Chang2008"}, title=None), "title", "confirmed, yet no title"),
        (("studies",), put({"key": "Chang2008"}, year=2009), "year", "Chang2008 says 2008, got"),
        (
            ("architectures", "attributes"), put({"mask": "Maskless"}, mask="Lens"), "mask",
            "Post2013 has no mask 'Lens'",
        ),
        (
            ("compensated_models", *MODELS), put(NONE, compensation="LUT"), "compensation",
            "has no model 'LUT'",
        ),
        (
            ("compensated_models", *MODELS), put(NONE, relation="within", model="Fourier"), "model",
            "has no model 'Fourier'",
        ),
        (("compensated_models", *MODELS), put(NONE, model="Gnomon"), "model", "model 'Gnomon'"),
        (("method_variants", *MODELS), put(NONE, model="Fourier"), "model", "no model 'Fourier'"),
        (("method_variants", *MODELS), put(NONE, runs_as="Sundial"), "runs_as", "unknown model"),
        (("method_variants", *MODELS), put(NONE, extractor="Squint"), "extractor", "unknown extra"),
    ],
)  # fmt: skip
def test_a_breach_of_a_rule_is_named_by_its_cell(
    frames: Frames, needed: tuple[str, ...], change: Change, column: str, said: str
) -> None:
    """The change is one of the first table that the rule needs."""
    table, looked_at = needed[0], {name: frames[name] for name in needed}
    assert check_rules(looked_at) == []
    found = breaches(looked_at, table, change)
    assert any(each[:3] == (file_name(table), 0, column) and said in each[3] for each in found), (
        found
    )


@pytest.mark.parametrize("known", ["Chang2008", "CildenGuler2021"])
def test_a_confirmation_is_of_a_study_of_either_edition(frames: Frames, known: str) -> None:
    rows = [[study, "Jane Doe", "2030-02-28", "every cell", ""] for study in (known, "Nobody1999")]
    confirmed = pd.DataFrame(rows, columns=frames["verifications"].columns)
    needed = {name: frames[name] for name in ("studies", "extension_studies")}
    (found,) = check_rules({**needed, "verifications": confirmed})
    place_of_it = f"{file_name('verifications')}, row 3, column study"
    assert str(found) == f"{place_of_it}: no study 'Nobody1999'"


def test_evidence_of_later_studies_is_checked_though_a_table_beside_is_missing(
    frames: Frames,
) -> None:
    later, at = put(NONE, basis="survey-text")(frames["extension_attributes"])
    found = check_rules({"extension_attributes": later})
    assert [(p.file, p.row, p.column, p.message) for p in found] == [
        (
            "extension/attributes.csv", at + FIRST_ROW, "basis",
            "survey-text, of a study outside the survey",
        )
    ]  # fmt: skip
