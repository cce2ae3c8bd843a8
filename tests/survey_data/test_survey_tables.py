"""What the shipped tables hold, and that the loader gives it unaltered."""

from __future__ import annotations

import csv
import itertools
import json

import frictionless
import pandas as pd
import pytest

import survey_data
from files.csv_writing import csv_text
from survey_data.accuracy_classes import accuracy_class
from survey_data.descriptor import DATA_DIRECTORY, column_types, file_name, table_names
from survey_data.table_records import read_records


def test_the_package_passes_frictionless_from_its_files() -> None:
    report = frictionless.validate(str(DATA_DIRECTORY / "datapackage.json"), type="package")
    assert report.valid, report.flatten(["type", "note"])
    assert [task.name for task in report.tasks] == list(table_names())


def test_the_descriptor_is_version_2_and_every_file_is_described() -> None:
    package = json.loads((DATA_DIRECTORY / "datapackage.json").read_text(encoding="utf-8"))
    assert package["$schema"] == "https://datapackage.org/profiles/2.0/datapackage.json"
    assert package["licenses"][0]["name"] == "CC-BY-4.0"
    assert {r["path"] for r in package["resources"]} == {
        path.relative_to(DATA_DIRECTORY).as_posix() for path in DATA_DIRECTORY.rglob("*.csv")
    }
    for resource in package["resources"]:
        assert resource["schema"].keys() & {"primaryKey", "uniqueKeys"}
        for field in resource["schema"]["fields"]:
            assert "categories" not in field  # frictionless does not enforce them


def test_the_strict_reader_agrees_with_the_standard_library() -> None:
    for table in table_names():
        path = DATA_DIRECTORY / file_name(table)
        records = read_records(path, list(column_types(table)))
        assert not records.problems
        with path.open(encoding="utf-8", newline="") as stream:
            expected = list(csv.reader(stream))
        assert [records.header, *(cells for _, cells in records.rows)] == expected
        assert [number for number, _ in records.rows] == list(range(2, len(expected) + 1))
        text = csv_text(records.header, [cells for _, cells in records.rows])
        assert text.encode() == path.read_bytes()  # an import rewrites nothing but its cells


@pytest.mark.parametrize("table", table_names())
def test_frames_hold_every_cell_of_their_file(table: str, tables: survey_data.SurveyTables) -> None:
    frame = getattr(tables, table)
    with (DATA_DIRECTORY / file_name(table)).open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(frame) == len(rows)
    for column, kind in column_types(table).items():
        for cell, row in zip(frame[column], rows, strict=True):
            text = row[column]
            if not text:
                assert pd.isna(cell)
            elif kind == "string":
                assert cell == text
            elif kind == "boolean":
                assert cell == (text == "true")
            else:
                assert cell == float(text)


def test_none_is_a_value_and_not_a_missing_cell(tables: survey_data.SurveyTables) -> None:
    models = tables.attributes.query("attribute == 'model' and value == 'None'")
    assert sorted(models["study"]) == [
        "Coutinho2022", "Enright2006b", "Enright2007b", "Enright2008a", "Enright2008b",
        "Enright2008c", "Godard2006", "He2005", "Kim2021", "Massari2004", "Minor2010", "Xie2008",
    ]  # fmt: skip
    extractors = tables.attributes.query("attribute == 'extractor' and value == 'None'")
    assert sorted(extractors["study"]) == ["Duan2006", "Mobasser2001"]


def test_the_assessment_is_19_by_21_and_its_known_rows_hold(
    tables: survey_data.SurveyTables,
) -> None:
    wide = tables.feature_assessment.pivot_table(
        index="extractor", columns="property", values="score"
    )
    assert wide.shape == (19, 21)
    assert not wide.isna().any().any()
    assert set(tables.feature_assessment["score"]) == {0, 1, 2}
    assert wide.loc["MCAM", "High precision"] == 2
    assert wide.loc["BCTM", "Robust to noise"] == 1
    assert wide.loc["Linear-phase", "Noise level agnostic"] == 1
    assert wide.loc["PM", "Sub-pixel resolution"] == 0
    totals = wide.sum(axis=1)  # row sums of the wide table the long one was made from
    assert totals["Voltage Balance"] == 18
    assert totals["Eigen-analysis"] == 16


@pytest.mark.parametrize(
    ("accuracy_deg", "expected"),
    [
        (10.0, "CSS"),
        (0.5, "CSS"),
        (0.499, "FSS"),
        (1.001 / 60, "FSS"),
        (0.999 / 60, "VFSS"),
        (10.01 / 3600, "VFSS"),
        (8.3 / 3600, "UFSS"),
        (0.0, "UFSS"),
    ],
)
def test_accuracy_classes_split_at_half_a_degree_an_arcminute_and_ten_arcseconds(
    accuracy_deg: float, expected: str, tables: survey_data.SurveyTables
) -> None:
    assert accuracy_class(tables.taxonomy, accuracy_deg) == expected


def test_no_two_values_of_an_attribute_share_a_name(tables: survey_data.SurveyTables) -> None:
    for _, group in tables.taxonomy.groupby("attribute"):
        for one, other in itertools.combinations(group["name"], 2):
            assert one.casefold() != other.casefold()
