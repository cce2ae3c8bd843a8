"""Loading refuses a table without rows, a key twice and a cell of another type, with the place."""

from __future__ import annotations

from typing import Any

import pytest

import survey_data
from survey_data.descriptor import column_types, file_name
from survey_data.tables import MAY_BE_EMPTY


def test_a_table_with_a_header_alone_is_refused_unless_it_may_be_empty(copy: Any) -> None:
    assert "architectures" in MAY_BE_EMPTY
    for table in ("architectures", "venues"):
        copy.edit(table, lambda rows: rows.__delitem__(slice(1, None)))
    with pytest.raises(survey_data.SurveyDataError) as refused:
        survey_data.load(copy.directory)
    said = "the table has a header and no rows"
    assert refused.value.problems == (survey_data.Problem("venues.csv", 1, None, said),)
    found = survey_data.validate(copy.directory)
    assert [(p.file, p.row) for p in found if p.message == said] == [("venues.csv", 1)]


@pytest.mark.parametrize(
    ("table", "key"), [("studies", ("key",)), ("attributes", ("study", "attribute", "value"))]
)
def test_a_key_that_stands_twice_is_refused_with_both_rows(
    table: str, key: tuple[str, ...], copy: Any
) -> None:
    rows = copy.rows(table)
    copy.write(table, [*rows, rows[4]])
    said = " ".join(rows[4][rows[0].index(name)] for name in key)
    with pytest.raises(survey_data.SurveyDataError) as refused:
        survey_data.load(copy.directory)
    assert refused.value.problems == (
        survey_data.Problem(
            file_name(table), len(rows) + 1, key[0], f"{said!r} stands in row 5 already"
        ),
    )


@pytest.mark.parametrize(
    ("table", "column", "text", "kind"),
    [
        ("attribute_definitions", "multiple", "perhaps", "boolean"),
        ("attribute_definitions", "multiple", "True", "boolean"),
        ("studies", "year", "MMX", "year"),
        ("bases", "rank", "1.5", "integer"),
        ("taxonomy", "min_deg", "wide", "number"),
    ],
)
def test_a_cell_that_is_not_of_its_column_s_type_is_refused(
    table: str, column: str, text: str, kind: str, copy: Any
) -> None:
    assert column_types(table)[column] == kind
    copy.set(table, 2, column, text)
    with pytest.raises(survey_data.SurveyDataError) as refused:
        survey_data.load(copy.directory)
    assert refused.value.problems == (
        survey_data.Problem(file_name(table), 2, column, f"expected {kind}, got {text!r}"),
    )
