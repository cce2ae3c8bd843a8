"""Tables as text: the cells of the files, and flaws of form with their place."""

import csv

import pytest

from survey_data.descriptor import DATA_DIRECTORY, file_name, table_names
from survey_data.editions import EXTENSION_TABLES
from survey_data.problems import SurveyDataError
from survey_data.texts import load_texts


def test_rows_are_those_that_the_csv_module_reads():
    tables = load_texts(table_names())
    for table in table_names():
        with (DATA_DIRECTORY / file_name(table)).open(encoding="utf-8", newline="") as lines:
            expected = list(csv.DictReader(lines))
        assert getattr(tables, table) == expected
        assert expected or table in EXTENSION_TABLES


def test_a_file_that_is_missing_or_broken_is_named_with_its_row(tmp_path):
    text = (DATA_DIRECTORY / "claims.csv").read_text(encoding="utf-8")
    (tmp_path / "claims.csv").write_text(text + "C99,one cell too few\n", encoding="utf-8")
    with pytest.raises(SurveyDataError) as refused:
        load_texts(["claims", "studies"], tmp_path)
    named = {(problem.file, problem.row) for problem in refused.value.problems}
    assert named == {("claims.csv", text.count("\n") + 1), ("studies.csv", None)}
