"""Scores, leaderboard and data sets, from a hand-made store whose every number is known."""

import math
import shutil
import statistics

import pytest

from api.server.app import create_app
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.metrics.score import METRICS
from benchmark.plan.parts import installed_parts
from benchmark.results import times
from benchmark.results.components import ComponentsError, current
from benchmark.results.csv_tables import text_of
from benchmark.results.store import Store, StoreError

CMOS = "cmos-single-aperture"
QPD = "qpd-single-aperture"
HALF_FOV = {CMOS: 60.0, QPD: 40.0}
CELLS = [
    # data set, condition, extractor, model, rms, bound, availability, latency
    (CMOS, "nominal", "bctm", "spm", 0.02, 0.001, 1.0, 5.0),
    (CMOS, "nominal", "bctm", "lsq", 0.01, 0.001, 1.0, 9.0),
    (CMOS, "nominal", "bcm", "spm", 0.5, 0.002, 0.98, 3.0),
    (CMOS, "nominal", "bcm", "lsq", None, None, None, None),
    (CMOS, "nominal", "tm", "spm", 0.005, 0.001, 0.94, 3.0),
    (CMOS, "misaligned", "bctm", "spm", 2.0, 0.001, 1.0, 5.0),
    (QPD, "nominal", "voltage-balance", "linear", 1.5, 0.05, 1.0, 1.0),
]
#: Errors of bctm's pipelines on units 1 to 4: spm's overlap those of lsq.
UNITS = {"spm": (0.009, 0.03, 0.02, 0.02), "lsq": (0.011, 0.012, 0.01, 0.01)}
#: Geometric mean of the five errors of bctm with spm, and its ratio to the standard unit's.
MEAN = (0.02 * 0.009 * 0.03 * 0.02 * 0.02) ** (1 / 5)
OWN = float(f"{MEAN:.5g}")  # as boards have it


def numbers_of(rms, bound, availability):
    if rms is None:
        return {"status": "failed", **dict.fromkeys(METRICS), "reason": "fit: too few samples"}
    metrics = dict.fromkeys(METRICS, 0.25) | {
        "false_detection_rate": None,
        "availability": availability,
    }
    metrics |= {
        "rms_deg": rms,
        "rms_all_answers_deg": rms,
        "bound_deg": bound,
        "over_bound": rms / bound,
    }
    metrics |= {"rms_0_10_deg": 2.0 * rms, "rms_10_20_deg": None}
    return {"status": "ok", **metrics, "reason": ""}


def stored_scores():
    scores = {Cell(*cell[:4]): numbers_of(*cell[4:7]) for cell in CELLS}
    for model, errors in UNITS.items():
        for unit, rms in enumerate(errors, start=1):
            scores[Cell(CMOS, "nominal", "bctm", model, unit)] = numbers_of(rms, 0.001, 1.0)
    return scores


def stored_pins():
    def pin(dataset, condition, bound):
        sizes = {"n": 200, "data_hash": "d" * 32, "head_hash": "h" * 32}
        bound_facts = {"observable": 190, "bound_deg": bound, "head_bound_deg": bound}
        return Pin(
            dataset,
            condition,
            "test",
            installed_parts().presets[dataset].version,
            **sizes,
            **bound_facts,
        )

    return [pin(CMOS, "nominal", 0.0015), pin(CMOS, "misaligned", 0.001), pin(QPD, "nominal", 0.05)]


@pytest.fixture(scope="module")
def components():
    return current(installed_parts()).only(stored_scores())


@pytest.fixture(scope="module")
def published(tmp_path_factory, components):
    directory = tmp_path_factory.mktemp("published")
    Store(directory).write(stored_scores(), stored_pins(), components)
    return directory


@pytest.fixture(scope="module")
def measured(tmp_path_factory, client_of, published):
    """A service with those scores, and with times of all but one pipeline."""
    directory = tmp_path_factory.mktemp("timed")
    shutil.copytree(published, directory, dirs_exist_ok=True)
    rows = [
        {
            "dataset": dataset,
            "extractor": extractor,
            "model": model,
            "ratio": latency / 4.0,
            "extract_ratio": 1.0,
        }
        for dataset, condition, extractor, model, *_, latency in CELLS
        if condition == "nominal" and latency is not None
    ]
    rows[0] |= {"ratio": 1.25}
    del rows[2]
    (directory / times.TIMES).write_text(text_of(list(rows[0]), rows))
    machine = times.Machine(
        processor="fake",
        cores=1,
        python="3.11",
        numpy="2.4",
        date="2026-11-28",
        loop="a loop",
        loop_us=4.0,
    )
    (directory / times.MACHINE).write_text(machine.model_dump_json())
    return client_of(create_app(Knowledge(Measurements(directory))))


@pytest.fixture(scope="module")
def unmeasured(tmp_path_factory, client_of):
    return client_of(create_app(Knowledge(Measurements(tmp_path_factory.mktemp("nothing")))))


def test_results_are_the_stored_numbers_of_the_standard_unit(measured):
    served = measured.walk("/v1/results?limit=4")
    known = {cell: numbers for cell, numbers in stored_scores().items() if cell.unit == 0}
    assert measured.get("/healthz").json()["scores"] == len(CELLS) == len(known)
    for row in served:
        cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"], row["unit"])
        assert {name: row[name] for name in known.pop(cell)} == stored_scores()[cell]
        assert row["half_fov_deg"] == HALF_FOV[cell.dataset]
        assert (row["n_test"], row["n_observable"], row["n_calibration"]) == (200, 190, None)
    assert known == {}


def test_the_leaderboard_ranks_by_the_error_over_a_part_of_the_field(measured):
    address = f"/v1/leaderboard/{CMOS}?condition=nominal&field_deg="
    board = measured.walk(f"{address}10")
    assert [(r["rank"], r["model"], r["field_deg"], r["field_rms_deg"]) for r in board] == [
        (1, "lsq", 10, 0.02),
        (3, "spm", 10, 1.0),
        (4, "spm", 10, 0.01),  # too few answers
        (2, "spm", 10, 0.04),  # behind the best of each extractor
        (None, "lsq", 10, None),
    ]
    beyond = measured.walk(f"{address}20")  # a ring without an error: no such field
    assert {(r["rank"], r["field_rms_deg"]) for r in beyond} == {(None, None)}
    refused = measured.get(f"{address}25")
    assert refused.status_code == 422
    assert "20" in refused.json()["errors"][0]["expected"]


DESIGN = "detector=CMOS&mask=Single-Ap.&model=SPM&extractor=BCTM"


def test_recommendations_carry_what_is_measured(measured):
    query = f"{DESIGN}&include=calibrations&evidence=measured"
    (place,) = measured.get(f"/v1/recommendations?{query}").json()["architectures"]
    (calibration,) = place["calibrations"]
    assert place["best"] == calibration
    logs = [math.log(error / OWN) for error in (0.02, *UNITS["spm"])]
    ratios = [sorted(logs)[int((at + 0.5) / 2)] for at in range(10)]
    spread = math.exp(2.0 * statistics.stdev(ratios) / math.sqrt(1 + len(UNITS["spm"])))
    assert calibration["measured"] == {
        "dataset": CMOS,
        "extractor": "bctm",
        "model": "spm",
        "condition": "nominal",
        "field_deg": 120.0,
        **dict.fromkeys(("flight_error_deg", "flight_low_deg", "flight_high_deg")),  # not flown
        "own_error_deg": pytest.approx(OWN, rel=1e-4),
        "own_deg": pytest.approx(OWN, rel=1e-4),  # its name until 0.3
        "own_low_deg": pytest.approx(OWN / spread, rel=1e-3),
        "own_high_deg": pytest.approx(OWN * spread, rel=1e-3),
        "on_bench_deg": None,
        "needs_bench_deg": None,
        "units_within": None,
        "bound_deg": 0.001,
        "availability": 1.0,
        "latency_us": 5.0,
        "needs": [],
    }


@pytest.mark.parametrize(
    "path", ["/v1/results", "/v1/leaderboard/cmos-single-aperture", "/v1/results?extractor=bcm"]
)
def test_where_nothing_is_published_lists_are_empty(unmeasured, path):
    assert unmeasured.get(path).json() == {"items": [], "total": 0, "next": None}
    assert unmeasured.table(path) == []
    assert unmeasured.get(path, accept="text/csv").text.count("\n") == 1


def test_a_published_file_that_cannot_be_read_stops_the_start(tmp_path, components):
    (tmp_path / "components.json").write_text("[]")
    with pytest.raises(ComponentsError, match=r"components\.json: expected schema"):
        Knowledge(Measurements(tmp_path)).load_all()
    (tmp_path / "components.json").write_text(components.text())
    (tmp_path / "scores").mkdir()
    (tmp_path / "scores" / "cmos-single-aperture.csv").write_text("condition,extractor\n")
    with pytest.raises(StoreError, match=r"cmos-single-aperture\.csv, line 1"):
        Knowledge(Measurements(tmp_path)).load_all()
