"""Scores, leaderboard and data sets, from a hand-made store whose every number is known."""

import json

import jsonschema
import pytest

from api.http.knowledge import Knowledge
from api.http.measurements import Measurements
from api.service import create_app
from benchmark import leaderboard
from benchmark.scoring import METRICS
from benchmark.store import Store, StoreError

CMOS = ("cmos-single-aperture", "CMOS", "Single-Ap.", 60.0)
QPD = ("qpd-single-aperture", "QPD", "Single-Ap.", 50.0)
TAXONOMY = {
    "bctm": "BCTM",
    "bcm": "BCM",
    "voltage-balance": "Voltage balance",
    "spm": "SPM",
    "lsq": "LSQ",
    "linear": "Linear",
}
CELLS = [
    # data set, condition, extractor, model, rms, bound, latency
    (CMOS, "nominal", "bctm", "spm", 0.02, 0.001, 5.0),
    (CMOS, "nominal", "bctm", "lsq", 0.01, 0.001, 9.0),
    (CMOS, "nominal", "bcm", "spm", 0.5, 0.002, 3.0),
    (CMOS, "nominal", "bcm", "lsq", None, None, None),
    (CMOS, "misaligned", "bctm", "spm", 2.0, 0.001, 5.0),
    (QPD, "nominal", "voltage-balance", "linear", 1.5, 0.05, 1.0),
]


def score_row(number, cell):
    (dataset, detector, mask, half_fov), condition, extractor, model, rms, bound, _ = cell
    metrics = dict.fromkeys(METRICS)
    if rms is not None:
        metrics |= dict.fromkeys(METRICS, 0.25)
        metrics |= {"rms_deg": rms, "bound_deg": bound, "over_bound": rms / bound}
        metrics |= {"found_fraction": 1.0 if extractor == "bctm" else 0.9}
    return {
        "schema": 1,
        "key": f"{number:064x}",
        "dataset": dataset,
        "dataset_version": 1,
        "condition": condition,
        "detector": detector,
        "mask": mask,
        "half_fov_deg": half_fov,
        "extractor": extractor,
        "extractor_taxonomy": TAXONOMY[extractor],
        "extractor_version": 1,
        "model": model,
        "model_taxonomy": TAXONOMY[model],
        "model_version": 1,
        "status": "failed" if rms is None else "ok",
        "reason": "fit: too few samples" if rms is None else "",
        "n_calibration": 100,
        "n_test": 200,
        **metrics,
        "data_hash": "0" * 64,
        "harness_version": 1,
        "metric_version": 1,
    }


def run_row(row, cell):
    named = {name: row[name] for name in ("key", "dataset", "condition", "extractor", "model")}
    return {**named, "latency_us": cell[-1], "time_ratio": None if cell[-1] is None else 2.0}


@pytest.fixture(scope="module")
def rows():
    return [score_row(number, cell) for number, cell in enumerate(CELLS)]


@pytest.fixture(scope="module")
def measured(tmp_path_factory, client_of, rows):
    directory = tmp_path_factory.mktemp("published")
    Store(directory).write(rows, [run_row(r, c) for r, c in zip(rows, CELLS, strict=True)], [])
    leaderboard.write(directory)
    return client_of(create_app(Knowledge(Measurements(directory))))


@pytest.fixture(scope="module")
def unmeasured(tmp_path_factory, client_of):
    return client_of(create_app(Knowledge(Measurements(tmp_path_factory.mktemp("nothing")))))


def cells_of(items):
    return {(i["dataset"], i["condition"], i["extractor"], i["model"]) for i in items}


def test_results_are_the_stored_rows(measured, rows):
    served = measured.walk("/v1/results?limit=4")
    assert sorted(served, key=lambda row: row["key"]) == rows
    assert measured.get("/healthz").json()["scores"] == len(CELLS)


@pytest.mark.parametrize(
    ("query", "kept"),
    [
        ("dataset=cmos-single-aperture", lambda r: r["detector"] == "CMOS"),
        ("condition=misaligned", lambda r: r["condition"] == "misaligned"),
        ("extractor=bcm&extractor=bctm", lambda r: r["extractor"] in {"bcm", "bctm"}),
        ("model=lsq&condition=nominal", lambda r: r["model"] == "lsq"),
        ("dataset=pd-maskless-cube", lambda r: False),
    ],
)
def test_results_narrow_by_their_fields(measured, rows, query, kept):
    assert cells_of(measured.walk(f"/v1/results?{query}")) == cells_of(filter(kept, rows))


def test_results_as_csv_are_the_same_numbers(measured):
    items = measured.walk("/v1/results")
    table = measured.table("/v1/results")
    assert len(table) == len(items)
    for row, item in zip(table, items, strict=True):
        assert set(row) == set(item)
        for name, value in item.items():
            assert row[name] == ("" if value is None else str(value)), name


def test_the_leaderboard_ranks_by_error_within_a_condition(measured):
    board = measured.walk("/v1/leaderboard/cmos-single-aperture?condition=nominal&limit=1")
    assert [(r["rank"], r["extractor"], r["model"]) for r in board] == [
        (1, "bctm", "lsq"),
        (2, "bctm", "spm"),
        (3, "bcm", "spm"),
        (None, "bcm", "lsq"),
    ]
    assert board[0]["time_ratio"] == 2.0
    assert board[-1]["status"] == "failed"
    assert board[-1]["reason"] == "fit: too few samples"
    whole = measured.get("/v1/leaderboard").json()
    assert [d["name"] for d in whole["datasets"]] == [CMOS[0], QPD[0]]
    assert len(measured.table("/v1/leaderboard")) == len(CELLS)


def test_measured_answers_fit_their_schemas(measured):
    document = measured.get("/openapi.json").json()
    for template in ("/v1/leaderboard", "/v1/leaderboard/{dataset}", "/v1/results", "/v1/datasets"):
        content = document["paths"][template]["get"]["responses"]["200"]["content"]
        schema = {**content["application/json"]["schema"], "components": document["components"]}
        answer = measured.get(template.format(dataset=CMOS[0])).json()
        jsonschema.Draft202012Validator(schema).validate(answer)
        assert answer.get("items", answer.get("datasets"))


def test_cards_name_conditions_and_published_bounds(measured):
    cards = {card["name"]: card for card in measured.walk("/v1/datasets")}
    cmos = cards[CMOS[0]]
    assert cmos["conditions"][0] == "nominal"
    assert set(cmos["setups"]) == set(cmos["conditions"])
    # Of the pipeline that found most: bctm found everything, bcm nine tenths.
    assert cmos["bounds"] == {"nominal": 0.001, "misaligned": 0.001}
    assert cards["pd-maskless-cube"]["bounds"] == {}


def test_recommendations_carry_what_is_measured_in_the_condition(measured):
    query = "detector=CMOS&mask=Single-Ap.&model=SPM&extractor=BCTM"
    nominal = measured.get(f"/v1/recommendations?{query}").json()["paths"]
    assert nominal
    for path in nominal:
        assert path["measured"] == {
            "dataset": CMOS[0],
            "condition": "nominal",
            "extractor": "bctm",
            "model": "spm",
            "rms_deg": 0.02,
            "bound_deg": 0.001,
            "over_bound": pytest.approx(20.0),
            "half_fov_deg": 60.0,
            "latency_us": 5.0,
        }
    other = measured.get(f"/v1/recommendations?{query}&condition=misaligned").json()["paths"]
    assert {path["measured"]["rms_deg"] for path in other} == {2.0}
    hot = measured.get(f"/v1/recommendations?{query}&condition=hot").json()["paths"]
    assert all(path["measured"] is None for path in hot)


def test_measured_columns_of_the_csv_are_empty_where_nothing_is_measured(measured):
    rows = measured.table("/v1/recommendations?detector=CMOS&limit=500")
    paths = measured.get("/v1/recommendations?detector=CMOS&limit=500").json()["paths"]
    assert len(rows) == len(paths)
    assert any(path["measured"] for path in paths)
    assert not all(path["measured"] for path in paths)
    for row, path in zip(rows, paths, strict=True):
        rms = path["measured"]["rms_deg"] if path["measured"] else None
        assert row["measured_rms_deg"] == ("" if rms is None else str(rms))
        assert row["literature_studies"] == str(path["literature"]["studies"])
        assert row["studies"] == "; ".join(path["studies"])
        assert "measured" not in row


def test_limits_are_judged_on_what_is_measured(measured):
    query = "detector=CMOS&mask=Single-Ap.&model=SPM&extractor=BCTM"
    for limit, met in [
        ("max_error_deg=0.02", True),
        ("max_error_deg=0.019", False),
        ("max_latency_us=5", True),
        ("max_latency_us=4.9", False),
        ("min_fov_deg=120", True),
        ("min_fov_deg=121", False),
    ]:
        answer = measured.get(f"/v1/recommendations?{query}&{limit}").json()
        assert (answer["count"] > 0) is met, limit
        assert (answer["blocked"] is None) is met


@pytest.mark.parametrize(
    "path",
    ["/v1/results", "/v1/leaderboard/cmos-single-aperture", "/v1/results?extractor=bcm"],
)
def test_where_nothing_is_published_lists_are_empty(unmeasured, path):
    assert unmeasured.get(path).json() == {"items": [], "total": 0, "next": None}
    assert unmeasured.table(path) == []
    assert unmeasured.get(path, accept="text/csv").text.count("\r\n") == 1


def test_where_nothing_is_published_the_rest_is_served(unmeasured):
    assert unmeasured.get("/v1/leaderboard").json() == {"schema": None, "datasets": []}
    assert unmeasured.get("/healthz").json()["scores"] == 0
    assert unmeasured.get("/v1/recommendations?task=Accuracy").json()["count"] > 0
    assert unmeasured.get("/v1/datasets").json()["total"] >= 3


def test_a_published_file_that_cannot_be_read_stops_the_start(tmp_path):
    (tmp_path / "leaderboard.json").write_text("[]")
    with pytest.raises(StoreError, match=r"leaderboard\.json: expected a JSON object"):
        Knowledge(Measurements(tmp_path)).load_all()
    (tmp_path / "leaderboard.json").unlink()
    (tmp_path / "scores.jsonl").write_text(json.dumps({"key": "x"}) + "\n")
    with pytest.raises(StoreError, match=r"scores\.jsonl, line 1"):
        Knowledge(Measurements(tmp_path)).load_all()
