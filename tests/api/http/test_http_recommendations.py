"""Recommendations as served: the survey's leading paths, their studies, and what blocks."""

import csv
from collections import defaultdict
from pathlib import Path

import survey_data

TABLES = Path(survey_data.__file__).parent
LEVELS = ("task", "detector", "mask", "model", "extractor")


def values():
    found = defaultdict(lambda: defaultdict(set))
    with (TABLES / "attributes.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["value"]:
                found[row["study"]][row["attribute"]].add(row["value"])
    with (TABLES / "roles.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["role"] == "compared":
                found[row["study"]][row["attribute"]].remove(row["value"])
    return found


def test_accuracy_leads_to_cmos_behind_multiple_apertures_and_encoded_masks(atlas):
    answer = atlas.get("/v1/recommendations?task=Accuracy").json()
    assert answer["nodes"]
    assert answer["links"]
    assert answer["blocked"] is None
    leading = [(path["detector"], path["mask"]) for path in answer["paths"][:10]]
    assert ("CMOS", "Multi-Ap.") in leading
    assert ("CMOS", "Encoded") in leading


def test_a_path_names_exactly_the_studies_that_have_its_values(atlas):
    of = values()
    answer = atlas.get("/v1/recommendations?limit=500").json()
    assert answer["count"] == len(answer["paths"]) > 100
    for path in answer["paths"]:
        taken = {key for key, v in of.items() if all(path[level] in v[level] for level in LEVELS)}
        assert set(path["studies"]) == taken
        assert path["literature"]["studies"] == len(taken)


def test_ranks_count_up_and_support_goes_down(atlas):
    paths = atlas.get("/v1/recommendations?limit=500").json()["paths"]
    assert [path["rank"] for path in paths] == list(range(1, len(paths) + 1))
    support = [path["literature"]["support"] for path in paths]
    assert support == sorted(support, reverse=True)


def test_limit_shortens_the_paths_and_nothing_else(atlas):
    whole = atlas.get("/v1/recommendations?task=Cost&limit=500").json()
    short = atlas.get("/v1/recommendations?task=Cost&limit=3").json()
    assert short == {**whole, "paths": whole["paths"][:3]}
    assert len(atlas.get("/v1/recommendations").json()["paths"]) == 20


def test_what_is_excluded_is_gone(atlas):
    query = "task=Accuracy&exclude_detector=CMOS&exclude_mask=Slit&limit=500"
    answer = atlas.get(f"/v1/recommendations?{query}").json()
    assert answer["count"] > 0
    assert all(p["detector"] != "CMOS" and p["mask"] != "Slit" for p in answer["paths"])
    assert not {"detector:CMOS", "mask:Slit"} & {node["id"] for node in answer["nodes"]}


def test_an_impossible_requirement_is_named_with_what_would_help(atlas):
    answer = atlas.get("/v1/recommendations?detector=Event&max_error_deg=0.0000001").json()
    assert (answer["count"], answer["paths"]) == (0, [])
    assert answer["blocked"]["constraint"] == "max_error_deg"
    for relaxation in answer["blocked"]["relaxations"]:
        assert relaxation["paths"] > 0


def test_relaxations_give_as_many_paths_as_they_promise(atlas):
    body = {"task": ["Accuracy"], "detector": ["LTF"], "mask": ["Encoded"]}
    blocked = atlas.post("/v1/recommendations", json=body).json()["blocked"]
    assert blocked["relaxations"]
    for relaxation in blocked["relaxations"]:
        relaxed = {k: v for k, v in body.items() if k not in relaxation.get("drop", {})}
        relaxed |= relaxation.get("change", {})
        found = atlas.post("/v1/recommendations", json=relaxed).json()
        assert found["count"] == relaxation["paths"] > 0


def test_the_requirements_are_repeated_as_understood(atlas):
    body = {"task": ["FOV", "Accuracy"], "exclude_mask": ["Lens"], "max_error_deg": 1}
    answer = atlas.post("/v1/recommendations", json=body).json()
    assert answer["requirements"] == {
        "task": ["Accuracy", "FOV"],
        "exclude_mask": ["Lens"],
        "max_error_deg": 1.0,
    }


def test_csv_rows_are_the_paths(atlas):
    paths = atlas.get("/v1/recommendations?task=FOV").json()["paths"]
    rows = atlas.table("/v1/recommendations?task=FOV")
    assert [{name: row[name] for name in ("rank", *LEVELS, "pareto")} for row in rows] == [
        {
            "rank": str(path["rank"]),
            **{level: path[level] for level in LEVELS},
            "pareto": "true" if path["pareto"] else "false",
        }
        for path in paths
    ]
    assert [row["studies"].split("; ") for row in rows] == [path["studies"] for path in paths]
