"""Values say what they rest on, and the tables beside them speak of values that there are."""

from __future__ import annotations

from typing import Any

import survey_data


def located(problems: list[survey_data.Problem], row: int, column: str) -> bool:
    return any((p.row, p.column) == (row, column) for p in problems)


def test_values_say_where_they_are_from(copy: Any) -> None:
    rows = copy.rows("attributes")
    for basis, column in (("abstract", "source"), ("inferred", "note"), ("survey-text", "source")):
        row = next(i for i, c in enumerate(rows, 1) if c[3] == basis)
        copy.set("attributes", row, column, "")
        assert located(copy.found("attributes.csv"), row, column)


def test_a_study_stands_for_one_of_its_methods_at_least(copy: Any) -> None:
    rows = copy.rows("roles")
    at = [i for i, c in enumerate(rows, 1) if c[0] == "Faizullin2017"]
    for row in at:
        copy.set("roles", row, "role", "compared")
    assert not copy.found("roles.csv")  # ECM, whose role is not known, is left
    copy.edit(
        "roles", lambda r: r.append(["Faizullin2017", "model", "ECM", "compared", "title", "", "x"])
    )
    assert any("compared every model" in p.message for p in copy.found("roles.csv"))


def test_sensors_of_a_study_use_all_its_detectors_and_masks(copy: Any) -> None:
    copy.set("architectures", 3, "mask", "N-Slit")  # PVA + N-Slit, and no maskless sensor
    assert any("'Maskless' on none" in p.message for p in copy.found("architectures.csv"))
