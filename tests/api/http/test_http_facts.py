"""Studies, taxonomy and flows as served, against a recount from the survey's CSV files."""

import csv
import itertools
from collections import defaultdict
from pathlib import Path

import pytest

import survey_data
from registry.taxonomy import taxonomy_row

TABLES = Path(survey_data.__file__).parent
ATTRIBUTES = ("task", "error", "accuracy", "detector", "mask", "model", "extractor")
CHARTS = {
    "error": ("error", "detector", "mask"),
    "performance": ("accuracy", "mask", "model_category"),
    "cross-analysis": ("task", "detector", "mask", "model", "extractor"),
    "task": ("task", "detector", "mask"),
    "model-sunburst": ("model_category", "calibration", "model"),
}


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


def test_all_129_studies_are_served_once(atlas, values):
    answer = atlas.get("/v1/studies?limit=500").json()
    assert answer["total"] == 129
    assert answer["next"] is None
    assert [item["key"] for item in answer["items"]] == list(values)


@pytest.mark.parametrize("limit", [pytest.param(1, marks=pytest.mark.slow), 7, 43, 128, 129, 130])
def test_pages_make_up_the_whole(atlas, limit):
    whole = atlas.get("/v1/studies?limit=500").json()["items"]
    assert atlas.walk(f"/v1/studies?limit={limit}") == whole


def test_filtered_pages_make_up_the_filtered_whole(atlas, values):
    expected = [
        key
        for key, of in values.items()
        if of["detector"] & {"CMOS", "CCD"} and "Multi-Ap." in of["mask"]
    ]
    query = "detector=CMOS&detector=CCD&mask=Multi-Ap."
    assert len(expected) > 3
    assert [item["key"] for item in atlas.walk(f"/v1/studies?{query}&limit=2")] == expected


@pytest.mark.parametrize("attribute", ATTRIBUTES)
def test_every_value_filters_to_the_studies_that_have_it(atlas, values, attribute):
    vocabulary = [row["value"] for row in read("taxonomy") if row["attribute"] == attribute]
    for value in vocabulary:
        kinds = {v for v in vocabulary if v == value or v.startswith(f"{value}/")}
        expected = [key for key, of in values.items() if of[attribute] & kinds]
        answer = atlas.request("GET", "/v1/studies", params={attribute: value, "limit": 500})
        assert [item["key"] for item in answer.json()["items"]] == expected, value


def test_years_and_words_narrow(atlas):
    studies = read("studies")
    years = {row["key"]: int(row["year"]) for row in studies if row["year"]}
    found = atlas.walk("/v1/studies?year_min=2005&year_max=2008&limit=10")
    assert {s["key"] for s in found} == {k for k, year in years.items() if 2005 <= year <= 2008}
    found = atlas.walk("/v1/studies?q=LIEBE%202001")
    texts = {
        r["key"]: " ".join(r[n] for n in ("key", "title", "authors", "venue")) for r in studies
    }
    expected = [k for k, text in texts.items() if "liebe" in text.lower() and "2001" in text]
    assert [item["key"] for item in found] == expected
    assert "Liebe2001" in expected
    assert atlas.walk("/v1/studies?year_min=2008&year_max=2005") == []
    assert atlas.walk("/v1/studies?q=nothing-has-this-word") == []


def test_states_partition_the_studies(atlas):
    parts = {s: atlas.walk(f"/v1/studies?state={s}") for s in ("complete", "partial", "none")}
    assert sum(map(len, parts.values())) == 129
    for state, items in parts.items():
        assert {item["state"] for item in items} <= {state}


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


def test_no_study_is_silent_about_what_cannot_be_run(atlas):
    for item in atlas.walk("/v1/studies"):
        study = atlas.get(f"/v1/studies/{item['key']}").json()
        if study["state"] == "complete":
            assert study["pipelines"]
            assert not study["gaps"]
        else:
            assert study["gaps"]
        for pipeline in study["pipelines"]:
            assert pipeline["settings"]
            for at, score in zip(pipeline["settings"], pipeline["scores"], strict=True):
                assert at["dataset"] in pipeline["datasets"]
                assert {name: score[name] for name in at} == at
        assert item["runs"]["pipelines"] == len(study["pipelines"])
        assert item["runs"]["cells"] == sum(len(p["settings"]) for p in study["pipelines"])


def test_grades_partition_the_studies_and_count_their_departures(atlas):
    grades = ("faithful", "assumed", "close", "stand-in", "none")
    parts = {grade: atlas.walk(f"/v1/studies?grade={grade}") for grade in grades}
    assert sum(map(len, parts.values())) == 129
    for grade, items in parts.items():
        for item in items[:4]:
            study = atlas.get(f"/v1/studies/{item['key']}").json()
            assert study["grade"] == item["grade"] == grade
            differ = sum(not one["unknown"] for one in study["departures"])
            assert (differ, grade) in {(0, "faithful"), (0, "assumed"), (1, "close")} or (
                differ > 1 and grade == "stand-in"
            )
            assert (study["departures"] == []) is (grade == "faithful")
            for departure in study["departures"]:
                assert departure["text"] in study["sentence"]
    assert atlas.get("/v1/studies?grade=perfect").status_code == 422


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


def test_csv_and_json_say_the_same_of_studies(atlas):
    items = atlas.get("/v1/studies?detector=QPD").json()["items"]
    rows = atlas.table("/v1/studies?detector=QPD")
    assert len(rows) == len(items) > 0
    for row, item in zip(rows, items, strict=True):
        for name in ("key", "title", "authors", "venue", "doi", "url", "identity", "state"):
            assert row[name] == item[name]
        assert row["year"] == str(item["year"])
        for attribute in ATTRIBUTES:
            assert row[attribute] == "; ".join(item["values"].get(attribute, []))


def test_csv_pages_carry_the_link(atlas):
    response = atlas.get("/v1/studies?limit=100", accept="text/csv")
    following = response.links["next"]["url"]
    rows = atlas.table("/v1/studies?limit=100") + atlas.table(following)
    assert len({row["key"] for row in rows}) == len(rows) == 129


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


def by_link(answer):
    return {(link["source"], link["target"]): set(link["studies"]) for link in answer["links"]}


@pytest.mark.parametrize("chart", ["error", "performance", "cross-analysis", "task"])
def test_links_are_the_studies_that_have_both_values(atlas, values, chart):
    levels = CHARTS[chart]
    expected = defaultdict(set)
    together = defaultdict(set)
    for row in read("architectures"):
        together[row["study"]].add((row["detector"], row["mask"]))
    for key, of in values.items():
        for one, two in itertools.pairwise(levels):
            for pair in itertools.product(of[one], of[two]):
                sensors = together.get(key, {pair})
                if (one, two) != ("detector", "mask") or pair in sensors:
                    expected[f"{one}:{pair[0]}", f"{two}:{pair[1]}"].add(key)
    answer = atlas.get(f"/v1/flows/{chart}").json()
    assert tuple(answer["levels"]) == levels
    assert by_link(answer) == expected
    assert all(link["value"] == len(link["studies"]) for link in answer["links"])


def test_a_filter_keeps_its_studies_and_their_wanted_values(atlas, values):
    answer = atlas.get("/v1/flows/error?error=Alignment&mask=Slit&mask=Multi-Ap.").json()
    expected = defaultdict(set)
    for key, of in values.items():
        masks = of["mask"] & {"Slit", "Multi-Ap."}
        if "Alignment" in of["error"] and masks:
            for detector in of["detector"]:
                expected["error:Alignment", f"detector:{detector}"].add(key)
                for mask in masks:
                    expected[f"detector:{detector}", f"mask:{mask}"].add(key)
    assert by_link(answer) == expected


@pytest.mark.parametrize("chart", CHARTS)
def test_fractional_inflow_equals_outflow(atlas, chart):
    answer = atlas.get(f"/v1/flows/{chart}?counting=fractional").json()
    levels = answer["levels"]
    inflow, outflow = defaultdict(float), defaultdict(float)
    for link in answer["links"]:
        outflow[link["source"]] += link["value"]
        inflow[link["target"]] += link["value"]
    for node in answer["nodes"]:
        if node["level"] != levels[0]:
            assert inflow[node["id"]] == pytest.approx(node["count"])
        if node["level"] != levels[-1]:
            assert outflow[node["id"]] == pytest.approx(node["count"])


def test_grouping_shows_categories(atlas, values):
    answer = atlas.get("/v1/flows/cross-analysis?grouped=true").json()
    assert answer["levels"] == ["task", "detector", "mask", "model_category", "extractor_family"]
    expected = {
        key
        for key, of in values.items()
        if "Multi-Ap." in of["mask"] and "Geometric" in of["model_category"]
    }
    assert by_link(answer)["mask:Multi-Ap.", "model_category:Geometric"] == expected


def test_nodes_of_links_exist_and_csv_is_the_links(atlas):
    for chart in CHARTS:
        answer = atlas.get(f"/v1/flows/{chart}").json()
        ids = {node["id"] for node in answer["nodes"]}
        assert {end for link in answer["links"] for end in (link["source"], link["target"])} <= ids
        rows = atlas.table(f"/v1/flows/{chart}")
        assert [
            {"source": link["source"], "target": link["target"], "value": f"{link['value']}",
             "studies": "; ".join(link["studies"])}
            for link in answer["links"]
        ] == rows  # fmt: skip
