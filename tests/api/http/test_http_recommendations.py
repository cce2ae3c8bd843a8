"""Recommendations as served: evidence, studies behind them, what blocks, sizes and pages."""

import csv
from collections import defaultdict
from pathlib import Path

import survey_data
from registry.taxonomy import taxonomy_rows

TABLES = Path(survey_data.__file__).parent
LEVELS = ("task", "detector", "mask", "model", "extractor")
PATH = "/v1/recommendations"


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


def test_the_survey_s_advice_is_named_with_its_section(atlas):
    found = atlas.get(f"{PATH}?task=Accuracy&limit=500").json()["architectures"]
    advised = {(a["detector"], a["mask"]) for a in found if a["advised"]}
    assert advised == {("CMOS", "Multi-Ap."), ("CMOS", "Encoded")}
    for architecture in found:
        for one in architecture["advised"]:
            assert one["value"] == "Accuracy"
            assert one["section_name"].startswith("Section 4")
        states = {one["requirement"]: one["advised"] for one in architecture["evidence"]}
        assert (states["task"] == "meets") == bool(architecture["advised"])


def test_a_path_names_exactly_the_studies_that_have_its_values(atlas):
    of = values()
    paths = atlas.get(f"{PATH}/flow").json()["paths"]
    assert len(paths) > 100
    for path in paths:
        taken = {key for key, v in of.items() if all(path[level] in v[level] for level in LEVELS)}
        assert set(path["studies"]) == taken
    assert atlas.get(f"{PATH}?include=paths").json()["paths"] == paths


def test_the_usual_answer_is_short_and_the_rest_is_included_on_request(atlas):
    usual = atlas.get(PATH)
    assert len(usual.content) <= 30_000
    assert all(a["calibrations"] is None for a in usual.json()["architectures"])
    more = atlas.get(f"{PATH}?include=calibrations,designs&calibrations=2&limit=4").json()
    for architecture in more["architectures"]:
        listed = architecture["calibrations"]
        assert len(listed) == min(2, architecture["count"])
        assert (
            listed[0]["measured"]["own_error_deg"]
            == architecture["best"]["measured"]["own_error_deg"]
        )
    assert len(more["rows"]["items"]) == 200 < more["rows"]["total"]
    following = atlas.get(more["rows"]["next"]).json()
    assert following["items"][0] not in more["rows"]["items"]
    assert following["total"] == more["rows"]["total"]


def test_where_the_measurement_misses_what_answers_too_seldom_is_named_with_its_share(atlas):
    asked = "max_error_deg=0.05&min_fov_deg=120&detector=CMOS&mask=Multi-Ap."
    (one,) = atlas.get(f"{PATH}?{asked}").json()["architectures"]
    finer = one["reason"].rpartition("; ")[2]
    pipeline, told = finer.split(" errs by ")
    extractor, model = pipeline.split(" + ", 1)
    rows = atlas.get("/v1/results?dataset=cmos-multi-aperture&condition=flight&limit=500").json()
    share = {
        row["availability"]
        for row in rows["items"]
        if (row["extractor"], row["model"]) == (extractor, model)
    }
    assert max(share) < 0.95
    assert told.endswith(f"but answers {max(share):.0%} of the readings.")
    assert float(told.split()[0]) < one["best"]["measured"]["own_error_deg"] / 3


def test_the_table_has_every_calibration_of_every_architecture(atlas):
    asked = "task=FOV&include=calibrations&calibrations=500&limit=500"
    found = atlas.get(f"{PATH}?{asked}").json()
    rows = atlas.table(f"{PATH}?task=FOV")
    assert len(rows) == sum(max(1, a["count"]) for a in found["architectures"])
    listed = [
        (str(a["rank"]), a["detector"], a["mask"], str(rank), one["name"],
         taxonomy_rows("model", one["model"]))
        for a in found["architectures"]
        for rank, one in enumerate(a["calibrations"], start=1)
    ]  # fmt: skip
    names = ("rank", "detector", "mask", "calibration", "name", "model")
    assert [tuple(row[name] for name in names) for row in rows if row["calibration"]] == listed


def test_a_body_takes_one_value_for_a_list_of_it(atlas):
    for name, value in [
        ("detector", "CMOS"),
        ("exclude_task", "Cost"),
        ("tolerate", "albedo"),
        ("include", "paths"),
    ]:
        single = atlas.post(PATH, json={name: value})
        assert single.status_code == 200, name
        assert single.content == atlas.post(PATH, json={name: [value]}).content
    for wrong in ("CMO", 1, None, {"CMOS": 1}):
        refused = atlas.post(PATH, json={"detector": wrong})
        assert refused.status_code == 422, wrong
        assert refused.json()["errors"][0]["parameter"] == "detector"
