"""Classes, numbers and kinds of accuracy agree in the table of attributes."""

from __future__ import annotations

from typing import Any

import pytest

import survey_data


def located(problems: list[survey_data.Problem], row: int, column: str | None = None) -> bool:
    """Say whether a problem names this row (and column, if one is given)."""
    return any(
        p.row == row and p.column is not None and (column is None or p.column == column)
        for p in problems
    )


def place(copy: Any, study: str, attribute: str) -> int:
    rows = copy.rows("attributes")
    return next(i for i, cells in enumerate(rows, 1) if cells[:2] == [study, attribute])


@pytest.mark.parametrize(
    ("basis", "attribute"),
    [
        ("survey-text", "accuracy"),
        ("authors-table", "accuracy_deg"),
        pytest.param("survey-text", "accuracy_deg", marks=pytest.mark.slow),
        pytest.param("authors-table", "accuracy", marks=pytest.mark.slow),
    ],
)
def test_a_printed_class_or_number_may_contradict_the_other(
    basis: str, attribute: str, copy: Any
) -> None:
    copy.set("attributes", place(copy, "Xie2012", "accuracy"), "value", "CSS")
    copy.set("attributes", place(copy, "Xie2012", attribute), "basis", basis)
    assert survey_data.validate(copy.directory) == []


def test_a_kind_needs_a_number_and_is_one_of_those_there_are(copy: Any) -> None:
    row = place(copy, "Sun2023", "accuracy_kind")
    copy.set("attributes", row, "value", "2sigma")
    assert located(copy.found("attributes.csv"), row, "value")
    copy.set("attributes", row, "value", "1sigma")
    rows = [c for c in copy.rows("attributes") if c[:2] != ["Sun2023", "accuracy_deg"]]
    copy.write("attributes", rows)
    assert located(copy.found("attributes.csv"), row - 1, "attribute")
