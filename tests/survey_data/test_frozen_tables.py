"""What holds of the tables that no command changes: the survey's words, and how they are read."""

from __future__ import annotations

import math
import re

import pandas as pd
import pytest

from survey_data import SurveyTables
from survey_data.findings.grammar import CATEGORY_OF, KINDS, PAIR, Vocabulary, parse_clause


@pytest.fixture(scope="module")
def vocabulary(tables: SurveyTables) -> Vocabulary:
    return Vocabulary(tables.taxonomy)


def words(column: pd.Series) -> set[str]:
    return set(column.dropna().astype(str))


def test_printed_labels_are_of_the_taxonomy_or_its_aliases(
    tables: SurveyTables, vocabulary: Vocabulary
) -> None:
    known = {(of, value) for of, values in vocabulary.values.items() for value in values}
    known |= set(zip(tables.aliases["attribute"], tables.aliases["alias"], strict=True))
    printed = tables.study_tables
    assert set(zip(printed["attribute"], printed["value"], strict=True)) <= known
    assessed = tables.feature_assessment["extractor"]
    assert {("extractor", each) for each in words(assessed)} <= known


def test_a_study_absent_from_a_printed_table_has_the_label_none_alone(tables: SurveyTables) -> None:
    printed = tables.study_tables
    table_of = {"model": "tab:mrlit", "extractor": "tab:felit"}
    source = printed["source"].str.removeprefix("absent from ")
    assert (source == printed["attribute"].map(table_of)).all()
    absent = printed["source"].str.startswith("absent")
    assert (absent == (printed["value"] == "None")).all()
    cells = printed.groupby(["study", "attribute"])["value"].agg(set)
    assert all(labels == {"None"} for labels in cells if "None" in labels)
    studies = tables.studies["key"]
    assert set(cells.index) == {(key, name) for key in studies for name in table_of}


def test_cited_keys_and_sections_exist(tables: SurveyTables) -> None:
    studies, cited = words(tables.studies["key"]), words(tables.references["key"])
    assert not studies & cited
    assert words(tables.claims["study"]) <= studies | cited
    assert words(tables.feature_assessment["case_study"]) <= studies | cited
    assert words(tables.claims["section"]) <= words(tables.taxonomy["survey_section"])
    assert words(tables.venues["study"]) <= words(tables.studies.dropna(subset=["venue"])["key"])


def test_an_extractor_is_assessed_by_every_property_with_one_case_study(
    tables: SurveyTables,
) -> None:
    frame = tables.feature_assessment
    assert not frame.duplicated(["extractor", "property"]).any()
    every = words(frame["property"])
    for _, rows in frame.groupby("extractor"):
        assert words(rows["property"]) == every
        assert rows["case_study"].nunique(dropna=False) == 1


def test_accuracy_classes_cover_every_angle_once(tables: SurveyTables) -> None:
    is_class = tables.taxonomy["attribute"] == "accuracy"
    limits = tables.taxonomy.loc[is_class, ["min_deg", "max_deg"]].sort_values("min_deg")
    upper = 0.0
    for least, most in limits.itertuples(index=False):
        assert least == upper
        upper = math.inf if math.isnan(most) else most
        assert upper > least
    assert math.isinf(upper)
    assert tables.taxonomy.loc[~is_class, ["min_deg", "max_deg"]].isna().all(axis=None)


def test_findings_have_clauses_that_run_on_and_name_known_values(
    tables: SurveyTables, vocabulary: Vocabulary
) -> None:
    for _, rows in tables.finding_clauses.groupby("finding"):
        assert rows["clause"].tolist() == list(range(1, len(rows) + 1))
    years = words(tables.studies["year"])
    for row in tables.finding_clauses.to_dict("records"):
        clause = parse_clause({str(name): cell for name, cell in row.items()})
        assert clause.kind in KINDS
        for attribute, values in (*clause.given, (clause.ranked, clause.values)):
            named = {one for value in values for one in value.split(" or ")}
            if attribute == PAIR:
                columns = zip(*(n.split("+") for n in named), strict=True)
                for part, each in zip(PAIR.split("+"), columns, strict=True):
                    assert set(each) <= vocabulary.values[part]
            elif attribute in CATEGORY_OF:
                assert named <= vocabulary.categories(attribute)
            else:
                assert named <= (vocabulary.values | {"year": years})[attribute]
        assert len(set(clause.values)) == len(clause.values) > (clause.kind == "order")
        assert clause.kind != "top-centroid" or clause.ranked == "extractor"
    assert words(tables.finding_clauses["finding"]) == words(tables.findings["id"])


@pytest.mark.parametrize(
    ("table", "letter"),
    [("findings", "F"), ("claims", "C"), ("defaults", "D"), ("purposes", "U"), ("advice", "A")],
)
def test_identifiers_and_ranks_run_on(table: str, letter: str, tables: SurveyTables) -> None:
    found = getattr(tables, table)["id"].tolist()
    assert found == [f"{letter}{number:02d}" for number in range(1, len(found) + 1)]
    assert tables.bases["rank"].tolist() == list(range(1, len(tables.bases) + 1))


def test_conditions_advice_and_families_speak_the_vocabulary(
    tables: SurveyTables, vocabulary: Vocabulary
) -> None:
    columns = (tables.defaults["given"], tables.purposes["given"], tables.purposes["unless"])
    for given in set().union(*map(words, columns)):
        for condition in given.split("&"):
            attribute, _, value = condition.partition("=")
            assert value in vocabulary.values[attribute]
    advice, values = tables.advice, vocabulary.values
    for name in ("detector", "mask"):
        assert words(advice[name]) <= values[name]
    assert words(advice["model_category"]) <= vocabulary.categories("model_category")
    families = vocabulary.categories("extractor_family")
    assert words(advice["extractor"]) <= values["extractor"] | families
    assert advice[["detector", "mask"]].notna().any(axis=1).all()
    assert words(tables.model_families["model"]) == values["model"] - {"None"}


def test_each_study_says_or_leaves_open_how_it_is_calibrated_and_what_its_sensor_is(
    tables: SurveyTables,
) -> None:
    facts = tables.run_facts
    assert (facts["value"].isna() == (facts["basis"] == "unknown")).all()
    ways = facts.loc[facts["fact"] == "calibration", "value"]
    assert words(ways) <= {"fitted", "in flight", "drawn"}
    for fact in ("calibration", "layout"):
        named = words(facts.loc[facts["fact"] == fact, "study"])
        assert named >= words(tables.studies["key"])


def test_products_of_a_family_are_of_one_kind_and_no_power_has_a_supply(
    tables: SurveyTables,
) -> None:
    hardware = tables.hardware
    for column in ("detector", "mask", "supply"):
        assert (hardware.groupby("family")[column].nunique() <= 1).all()
    powered = hardware.dropna(subset=["power_mw"])
    assert ((powered["power_mw"] == 0.0) == powered["supply"].notna()).all()
    assert all(re.fullmatch(r"[CP]\d{2}", each) for each in hardware["id"])
