"""Columns, values and studies of another table are matched, and guesses are not made."""

from __future__ import annotations

import pandas as pd
import pytest

import survey_data
from survey_data import SurveyImportError
from survey_data.importing.columns import ColumnMapping, match_columns
from survey_data.importing.studies import StudyFinder, StudyNotFoundError
from survey_data.importing.values import UnreadableValueError, ValueReader, column_unit


def frame(**columns: list[str | None]) -> pd.DataFrame:
    return pd.DataFrame(
        {name.replace("_", " "): cells for name, cells in columns.items()}, dtype="str"
    )


def targets_of(mapping: ColumnMapping) -> dict[str, str]:
    return {match.column: match.target for match in mapping.matches}


def test_columns_are_matched_by_name(tables: survey_data.SurveyTables) -> None:
    mapping = match_columns(
        tables,
        frame(
            Bibtex=["Chang2008", "He2005"],
            Sensor_type=["CMOS", "APS"],
            Mask_Geometry=["Pinhole", "Slit"],
            Main_task=["Accuracy", "Cost"],
            Publication_Year=["2008", "2005"],
            Remarks=["nice", "also nice"],
        ),
    )
    assert targets_of(mapping) == {
        "Bibtex": "study", "Sensor type": "detector",
        "Mask Geometry": "mask", "Main task": "task", "Publication Year": "year",
    }  # fmt: skip
    assert mapping.ignored == ("Remarks",)


@pytest.mark.parametrize(
    ("cells", "target"), [(["0.05", "< 3 arcmin"], "accuracy_deg"), (["Fine", "VFSS"], "accuracy")]
)
def test_a_column_of_accuracies_is_told_by_its_cells(
    cells: list[str | None], target: str, tables: survey_data.SurveyTables
) -> None:
    mapping = match_columns(tables, frame(Key=["Chang2008", "He2005"], Accuracy=cells))
    assert targets_of(mapping)["Accuracy"] == target


def test_numbered_columns_are_united(tables: survey_data.SurveyTables) -> None:
    given = frame(Key=["Chang2008"], Task_1=["Accuracy"], Task_2=["Cost"], Task_3=[None])
    assert match_columns(tables, given).columns("task") == ("Task 1", "Task 2", "Task 3")


def test_an_override_decides(tables: survey_data.SurveyTables) -> None:
    given = frame(Key=["Chang2008"], A=["Slit"], Mask=["Slit"])
    mapping = match_columns(tables, given, {"A": "model", "Mask": "-"})
    assert targets_of(mapping) == {"Key": "study", "A": "model"}
    assert mapping.ignored == ("Mask",)


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ({"Masc": "mask"}, r"column Masc.*\(did.*'Mask'\?\)"),
        ({"Mask": "masque"}, r"column Mask.*'masque' \(did.*'mask'\?"),
        ({"Key": "study", "Mask": "study"}, "study takes one column"),
        ({"Key": "-"}, "no column identifies the study"),
        ({"Mask": "-"}, "no column holds an attribute"),
    ],
)
def test_an_impossible_mapping_is_refused(
    overrides: dict[str, str], expected: str, tables: survey_data.SurveyTables
) -> None:
    given = frame(Key=["Chang2008"], Mask=["Slit"])
    with pytest.raises(SurveyImportError, match=expected):
        match_columns(tables, given, overrides)


@pytest.mark.parametrize(
    ("attribute", "text", "expected"),
    [
        ("mask", "Slit", ["Slit"]),
        ("mask", "pinhole", ["Single-Ap."]),
        ("mask", "Single aperture", ["Single-Ap."]),
        ("mask", "Multiple slits", ["Multi-Slit"]),
        ("detector", "CMOS APS", ["CMOS"]),
        ("detector", "CMOS / Event", ["CMOS", "Event"]),
        ("detector", "PD and QPD", ["PD", "QPD"]),
        ("detector", "Photodiodes", ["PD"]),
        ("model", "ECM/Noise", ["ECM/Noise"]),
        ("model", "SECM/Solar, ICM/Shadow", ["SECM/Solar", "ICM/Shadow"]),
        ("model", "LUT/Polynomial", ["LUT", "Polynomial"]),
        ("model", "Polynomials; LUT\nLUT", ["Polynomial", "LUT"]),
        ("model", "Code", ["Coded"]),
        ("model", "ECM", ["ECM"]),
        ("model", "None", ["None"]),
        ("task", "None", []),
        ("task", "n/a", []),
        ("task", "-", []),
        ("task", "?", []),
        ("task", "Unknown", []),
        ("extractor", "Voltage-Balance", ["Voltage balance"]),
        ("extractor", "MT ACM", ["MT-ACM"]),
        ("extractor", "Linear phase", ["Linear-phase"]),
        ("accuracy", "Fine", ["FSS"]),
        ("accuracy", "Very fine", ["VFSS"]),
        ("accuracy", "Fine sun sensor (better than 0.5 deg, down to about one arcminute)", ["FSS"]),
        ("accuracy", "0.1°", ["FSS"]),
        ("accuracy", "5 arcsec", ["UFSS"]),
        ("accuracy_deg", "0.05", ["0.05"]),
        ("accuracy_deg", "0,05", ["0.05"]),
        ("accuracy_deg", "~ 0.1 deg", ["0.1"]),
        ("accuracy_deg", "±0.1°", ["0.1"]),
        ("accuracy_deg", "3 arcmin", ["0.05"]),
        ("accuracy_deg", "36″", ["0.01"]),
        ("fov_deg", "±60°", ["120"]),
        ("fov_deg", "+/- 64", ["128"]),
        ("fov_deg", "120 x 120 deg", ["120"]),
    ],
)
def test_values_are_read(
    attribute: str, text: str, expected: list[str], tables: survey_data.SurveyTables
) -> None:
    assert ValueReader(tables).read(attribute, text) == expected


@pytest.mark.parametrize(
    ("attribute", "text", "expected"),
    [
        ("mask", "Sundial", "no value of mask"),
        ("error", "Manufacturng", "the nearest is 'Manufacturing'"),
        ("extractor", "BCXM", "no value"),  # one letter from BCTM and no guess
        ("extractor", "BCTM, Sundial", "'Sundial'"),
        ("detector", "CMOS/Sundial", "'Sundial'"),
        ("model", "SECM", "may stand for SECM/Solar or SECM/Temperature"),
        ("accuracy_deg", "fine", "expected an angle"),
        ("accuracy_deg", "270", "out of range"),
        ("fov_deg", "120 x 60", "two different angles"),
    ],
)
def test_what_is_no_value_is_not_guessed(
    attribute: str, text: str, expected: str, tables: survey_data.SurveyTables
) -> None:
    with pytest.raises(UnreadableValueError, match=expected):
        ValueReader(tables).read(attribute, text)


def test_every_value_and_name_of_the_taxonomy_is_read_as_itself(
    tables: survey_data.SurveyTables,
) -> None:
    reader = ValueReader(tables)
    for row in tables.taxonomy.to_dict("records"):
        for text in (row["value"], str(row["value"]).upper(), row["name"]):
            if row["value"] == "None":
                continue
            assert reader.read(row["attribute"], text) == [row["value"]], text


@pytest.mark.parametrize(
    ("column", "unit"),
    [("Accuracy (arcsec)", "arcsec"), ("acc_arcmin", "arcmin"), ("Accuracy [deg]", "deg")],
)
def test_a_column_s_name_gives_the_unit(column: str, unit: str) -> None:
    assert column_unit(column) == unit


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({"study": "Chang2008"}, "Chang2008"),
        ({"study": "chang2008"}, "Chang2008"),
        ({"study": "Allegeier2009"}, "Allgeier2009"),
        ({"title": "Fuzzy Image Processing in Sun Sensors"}, "Mobasser2001"),
        ({"study": "1", "title": "Fuzzy image processing in sun sensors"}, "Mobasser2001"),
        ({"authors": "A. Ali; F. Tanveer", "year": "2011"}, "Ali2011"),
        ({"authors": "Ali, A., Tanveer, F.", "year": "2011"}, "Ali2011"),
        ({"authors": "C. W. de Boom and N. van der Heiden", "year": "2003"}, "deBoom2003"),
        ({"authors": "Maqsood et al.", "year": "2010"}, "Maqsood2010"),
    ],
)
def test_studies_are_found(
    said: dict[str, str], expected: str, tables: survey_data.SurveyTables
) -> None:
    assert StudyFinder(tables).find(**said) == expected


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({}, "names no study"),
        ({"study": "Nobody1999"}, "no study has the key"),
        ({"study": "Adatrao2016"}, "no study has the key"),  # a reference, not a mapped study
        ({"title": "A sundial"}, "no study has the title"),
        ({"authors": "Chang", "year": "1999"}, "no study by"),
        ({"authors": "J. Enright", "year": "2008"}, "Enright2008a or Enright2008b"),
        ({"authors": "", "year": "2008"}, "names no study"),
    ],
)
def test_a_study_is_not_guessed(
    said: dict[str, str], expected: str, tables: survey_data.SurveyTables
) -> None:
    with pytest.raises(StudyNotFoundError, match=expected):
        StudyFinder(tables).find(**said)


def test_every_titled_study_is_found_by_its_title_alone(tables: survey_data.SurveyTables) -> None:
    finder = StudyFinder(tables)
    titles = tables.studies.dropna(subset=["title"])
    shared = titles["title"].duplicated(keep=False)
    for key, title in zip(titles.loc[~shared, "key"], titles.loc[~shared, "title"], strict=True):
        assert finder.find(title=title.upper()) == key


def test_a_column_called_as_ours_is_taken_though_some_cells_cannot_be_read(
    tables: survey_data.SurveyTables,
) -> None:
    given = frame(Key=["Chang2008", "He2005", "Xie2008"], Mask=["Slit", "Sundial", "Gnomon"])
    assert targets_of(match_columns(tables, given))["Mask"] == "mask"
    given["Mask"] = ["12", "14", "16"]  # something else altogether
    with pytest.raises(SurveyImportError, match="no column holds an attribute"):
        match_columns(tables, given)


@pytest.mark.parametrize(
    "text",
    [">0.1", "<0.1", "≥ 0.1 deg", "<= 0.1", "0.1 0.2", "１.０", "1_29", "0x10", "nan", "inf"],
)
@pytest.mark.parametrize("attribute", ["accuracy_deg", "accuracy"])
def test_limits_and_what_is_no_plain_number_are_refused(
    attribute: str, text: str, tables: survey_data.SurveyTables
) -> None:
    reader = ValueReader(tables)
    if text == "nan":  # how tables say that nothing is stated
        assert reader.read(attribute, text) == []
        return
    with pytest.raises(UnreadableValueError):
        reader.read(attribute, text)


def test_a_huge_cell_is_refused_and_a_long_one_split_in_one_pass(
    tables: survey_data.SurveyTables,
) -> None:
    reader = ValueReader(tables)
    with pytest.raises(UnreadableValueError, match="at most 5000 characters"):
        reader.read("mask", "(" * 100_000)
    assert reader.read("mask", "(," * 2000) == []
