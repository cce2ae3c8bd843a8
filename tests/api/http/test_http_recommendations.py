"""Recommendations as served: the survey's leading paths, their studies, and what blocks."""

import csv
from collections import defaultdict
from pathlib import Path

import survey_data
from registry.taxonomy import taxonomy_rows

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


def test_the_survey_s_advice_is_marked_and_weighs_at_most_a_factor_of_two(atlas):
    answer = atlas.get("/v1/recommendations?task=Accuracy").json()
    assert answer["nodes"]
    assert answer["links"]
    assert answer["blocked"] is None
    advised = {(a["detector"], a["mask"]) for a in answer["architectures"] if a["advised"]}
    assert advised == {("CMOS", "Multi-Ap."), ("CMOS", "Encoded")}
    errors = [a["best"]["measured"]["error_deg"] for a in answer["architectures"][:10]]
    for at, error in enumerate(errors):
        assert error <= 2 * min(errors[at:]), "evidence makes up for at most that much"
    assert errors != sorted(errors), "evidence decides nothing"
    for architecture in answer["architectures"]:
        assert architecture["advised"] == bool(architecture["advice"])
        assert all(a["section"] and a["value"] == "Accuracy" for a in architecture["advice"])


def test_a_path_names_exactly_the_studies_that_have_its_values(atlas):
    of = values()
    answer = atlas.get("/v1/recommendations?limit=500").json()
    assert len(answer["paths"]) > 100
    for path in answer["paths"]:
        taken = {key for key, v in of.items() if all(path[level] in v[level] for level in LEVELS)}
        assert set(path["studies"]) == taken


def test_ranks_count_up_and_support_goes_down_if_asked_for(atlas):
    query = "sort=support&limit=500&calibrations=500"
    found = atlas.get(f"/v1/recommendations?{query}").json()["architectures"]
    assert [a["rank"] for a in found] == list(range(1, len(found) + 1))
    sizes = [len(a["studies"]) for a in found]
    assert sizes == sorted(sizes, reverse=True)
    for a in found:
        ranks = [one["rank"] for one in a["calibrations"]]
        assert ranks == list(range(1, a["count"] + 1))
        named = [one for one in a["calibrations"] if "None" not in (one["extractor"], one["model"])]
        support = [one["support"] for one in named]
        assert support == sorted(support, reverse=True)


def test_what_is_measured_comes_first_if_asked_for(atlas):
    found = atlas.get("/v1/recommendations?sort=measured&limit=500&calibrations=1").json()
    errors = [
        (a["best"]["measured"] or {}).get("error_deg") or float("inf")
        for a in found["architectures"]
    ]
    assert errors == sorted(errors)
    assert found["regret"]["ratio"] == 1.0
    best = found["architectures"][0]
    assert best["calibrations"][0] == best["best"]


def test_an_encoded_mask_shows_the_error_of_its_own_correlation(atlas):
    (first, *_) = atlas.get("/v1/recommendations?mask=Encoded").json()["architectures"]
    assert (first["detector"], first["best"]["model"]) == ("CMOS", "Coded")
    assert first["best"]["measured"]["error_deg"] < 0.01
    assert first["best"]["measured"]["nominal"]["bound_deg"] > 0


def test_limits_shorten_architectures_and_calibrations_and_nothing_else(atlas):
    whole = atlas.get("/v1/recommendations?task=Cost&limit=500&calibrations=500").json()
    short = atlas.get("/v1/recommendations?task=Cost&limit=3&calibrations=2").json()
    cut = [{**a, "calibrations": a["calibrations"][:2]} for a in whole["architectures"][:3]]
    assert short == {**whole, "architectures": cut}
    usual = atlas.get("/v1/recommendations").json()["architectures"]
    assert len(usual) == 20
    assert max(len(a["calibrations"]) for a in usual) == 5


def test_what_is_excluded_is_gone(atlas):
    query = "task=Accuracy&exclude_detector=CMOS&exclude_mask=Slit&exclude_model=LUT"
    answer = atlas.get(f"/v1/recommendations?{query}&limit=500&calibrations=500").json()
    assert answer["count"] > 0
    found = answer["architectures"]
    assert all(a["detector"] != "CMOS" and a["mask"] != "Slit" for a in found)
    assert all(c["model"] != "LUT" for a in found for c in a["calibrations"])
    gone = {"detector:CMOS", "mask:Slit", "model:LUT"}
    assert not gone & {node["id"] for node in answer["nodes"]}


def test_what_no_data_set_tries_is_told(atlas):
    answer = atlas.get("/v1/recommendations?survive=missing-apertures&limit=500").json()
    untried = {(p["detector"], p["mask"]) for p in answer["untried"]["missing-apertures"]}
    kept = {(a["detector"], a["mask"]) for a in answer["architectures"]}
    assert untried
    assert not untried & kept
    assert all(a["best"]["basis"]["survive"] == "measured" for a in answer["architectures"])


def test_an_impossible_requirement_is_named_with_what_would_help(atlas):
    answer = atlas.get("/v1/recommendations?detector=Event&max_error_deg=0.0000001").json()
    assert (answer["count"], answer["architectures"], answer["paths"]) == (0, [], [])
    assert answer["blocked"]["constraint"] == "max_error_deg"
    for relaxation in answer["blocked"]["relaxations"]:
        assert relaxation["architectures"] > 0
        assert "an error of at most" in relaxation["words"]


def test_relaxations_give_as_many_architectures_as_they_promise(atlas):
    body = {"task": ["Accuracy"], "detector": ["LTF"], "mask": ["Encoded"]}
    blocked = atlas.post("/v1/recommendations", json=body).json()["blocked"]
    assert blocked["relaxations"]
    for relaxation in blocked["relaxations"]:
        relaxed = {k: v for k, v in body.items() if k not in relaxation.get("drop", {})}
        relaxed |= relaxation.get("change", {})
        found = atlas.post("/v1/recommendations", json=relaxed).json()
        assert found["count"] == relaxation["architectures"] > 0


def test_the_requirements_are_repeated_as_understood(atlas):
    body = {"task": ["FOV", "Accuracy"], "exclude_mask": ["Lens"], "max_error_deg": 1}
    answer = atlas.post("/v1/recommendations", json=body).json()
    assert answer["requirements"] == {
        "task": ["Accuracy", "FOV"],
        "exclude_mask": ["Lens"],
        "max_error_deg": 1.0,
    }


def test_csv_rows_are_the_calibrations_of_the_architectures(atlas):
    found = atlas.get("/v1/recommendations?task=FOV").json()["architectures"]
    rows = atlas.table("/v1/recommendations?task=FOV")
    names = ("rank", "detector", "mask", "advised", "calibration", "extractor", "model")
    assert [{name: row[name] for name in names} for row in rows] == [
        {
            "rank": str(a["rank"]),
            "detector": a["detector"],
            "mask": a["mask"],
            "advised": "true" if a["advised"] else "false",
            "calibration": str(one["rank"]),
            "extractor": taxonomy_rows("extractor", one["extractor"]),
            "model": taxonomy_rows("model", one["model"]),
        }
        for a in found
        for one in a["calibrations"]
    ]
    assert [row["calibration_studies"] for row in rows] == [
        "; ".join(one["studies"]) for a in found for one in a["calibrations"]
    ]


def test_a_number_below_its_smallest_is_refused_in_words(atlas):
    """Some limits take their least value, a bench of 0 deg among them; others do not."""
    for name, expected in (("bench_deg", "of at least 0"), ("max_error_deg", "above 0")):
        answer = atlas.get("/v1/recommendations", params={name: -1})
        assert answer.status_code == 422
        assert expected in answer.json()["errors"][0]["expected"]
