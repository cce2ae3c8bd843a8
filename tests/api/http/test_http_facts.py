"""Studies, taxonomy and flows as served, against a recount from the survey's CSV files."""

import csv
from collections import defaultdict
from pathlib import Path

import pytest

import survey_data
from registry.taxonomy import taxonomy_row

TABLES = Path(survey_data.__file__).parent
ATTRIBUTES = ("task", "error", "accuracy", "detector", "mask", "model", "extractor")


def read(name):
    with (TABLES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def values():
    """study -> attribute -> set of values, counted without the project's code."""
    found = {row["key"]: defaultdict(set) for row in read("studies")}
    category = {(r["attribute"], r["value"]): r["category"] for r in read("taxonomy")}
    for row in read("attributes"):
        attribute, value = row["attribute"], row["value"]
        if value == "":
            continue
        found[row["study"]][attribute].add(value)
        if attribute == "model":
            found[row["study"]]["model_category"].add(category["model", value])
        if attribute == "extractor":
            found[row["study"]]["extractor_family"].add(category["extractor", value])
    return found


@pytest.mark.parametrize("attribute", ATTRIBUTES)
def test_every_value_filters_to_the_studies_that_have_it(atlas, values, attribute):
    vocabulary = [row["value"] for row in read("taxonomy") if row["attribute"] == attribute]
    for value in vocabulary:
        kinds = {v for v in vocabulary if v == value or v.startswith(f"{value}/")}
        expected = [key for key, of in values.items() if of[attribute] & kinds]
        answer = atlas.request("GET", "/v1/studies", params={attribute: value, "limit": 500})
        assert [item["key"] for item in answer.json()["items"]] == expected, value


def row_role(row):
    return "unknown" if row["attribute"] in {"model", "extractor"} else ""


def test_a_study_carries_every_cell_with_its_basis(atlas):
    roles = {
        (row["attribute"], row["value"]): row["role"]
        for row in read("roles")
        if row["study"] == "Chang2008"
    }
    assert set(roles.values()) == {"proposed", "compared"}
    said = {
        "tab:mrlit": "Table 2 “Overview of model representation literature”",
        "tab:felit": "Table 3 “Overview of feature extraction literature”",
    }
    expected = [
        {k: v for k, v in row.items() if k != "study"}
        | {"role": roles.get((row["attribute"], row["value"]), row_role(row))}
        | {"name_in_study": "", "nearest": False}
        | {"source_name": said.get(row["source"], row["source"])}
        for row in read("attributes")
        if row["study"] == "Chang2008"
    ]
    study = atlas.get("/v1/studies/Chang2008").json()
    assert {cell["source"] for cell in study["attributes"]} >= set(said)

    def sort_key(cell):
        return (cell["attribute"], cell["value"])

    assert sorted(study["attributes"], key=sort_key) == sorted(expected, key=sort_key)
    listed = atlas.walk("/v1/studies?q=Chang2008")[0]
    assert {name: study[name] for name in listed} == listed


def test_a_study_is_shown_by_its_score_where_it_stands_for_it(atlas):
    study = atlas.get("/v1/studies/Nurgizat2021").json()
    assert study["purposes"].keys() == {"albedo"}
    head = study["headline"]
    assert (head["dataset"], head["condition"]) == ("pva-maskless-panels", "albedo")
    query = "dataset=pva-maskless-panels&condition=albedo&extractor=direct&model=solar-panel"
    (row,) = atlas.walk(f"/v1/results?{query}")
    assert head["rms_deg"] == row["rms_deg"]
    # what is not measured where it stands for the study has no score of another place
    for item in atlas.walk("/v1/studies"):
        study = atlas.get(f"/v1/studies/{item['key']}").json()
        at = [p["scores"][0] for p in study["pipelines"]]
        if all(score["rms_deg"] is None for score in at):
            assert study["headline"] is None


def test_the_taxonomy_is_the_table(atlas):
    served = atlas.get("/v1/taxonomy").json()["attributes"]
    flat = [{"attribute": a, **entry} for a, entries in served.items() for entry in entries]
    expected = [
        {**{k: row[k] for k in ("attribute", "value", "name", "category")},
         "section": row["survey_section"]}
        for row in read("taxonomy")
    ]  # fmt: skip
    title = {row["label"]: row["title"] for row in read("labels")}
    for row in flat:
        assert title.get(row["section"], "") in row["section_name"]
    assert [{k: v for k, v in row.items() if k != "section_name"} for row in flat] == expected
    exported = [{k: "" if v is None else v for k, v in taxonomy_row(row).items()} for row in flat]
    assert atlas.table("/v1/taxonomy") == exported  # "None" is a value, and no empty cell
