"""Findings: what each counts, against an independent script and records made up by hand."""

from __future__ import annotations

import csv
import json
import math
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from api.deposit.derived_tables import resolution
from benchmark.contract import Cell
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.leaderboard.findings import Finding, FindingsRecord, findings_of
from benchmark.leaderboard.findings.finding import number
from benchmark.leaderboard.findings.measured import benches, constants, methods, poses, sources
from benchmark.metrics.ranking import UnitErrors
from benchmark.plan.combinations import scorable_plan
from benchmark.plan.shown import data_sets
from benchmark.results.store import PUBLISHED
from registry.resolution import Resolution, resolve_all

Errors = Mapping[tuple[str, str, str], Sequence[float]]
SCRIPT = Path(__file__).parent / "recompute_findings.py"


@pytest.fixture(scope="module")
def published() -> Mapping[str, Finding]:
    resolutions = resolve_all(scorable_plan(), data_sets=data_sets())
    return {one.key: one for one in findings_of(FindingsRecord.published(), resolutions)}


@pytest.fixture(scope="module")
def again(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What the script finds in the published files, in a process that imports nothing of ours."""
    table = tmp_path_factory.mktemp("deposit") / "resolution.csv"
    rows = resolution(own={})
    with table.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)
    call = [sys.executable, "-I", str(SCRIPT), str(PUBLISHED), str(table)]
    done = subprocess.run(call, capture_output=True, check=True, text=True, cwd=table.parent)
    return cast("dict[str, Any]", json.loads(done.stdout))


def test_the_script_imports_nothing_that_it_checks() -> None:
    imported = re.findall(r"^(?:import|from) (\w+)", SCRIPT.read_text("utf-8"), re.MULTILINE)
    assert set(imported) == {"json", "math", "sys", "pathlib", "numpy", "pandas"}


def test_the_methods_of_studies_come_out_the_same_by_another_way(
    published: Mapping[str, Finding], again: Mapping[str, Any]
) -> None:
    found = published["methods"]
    own, bench = found.estimates
    for ours, theirs in ((own, again["own"]), (bench, again["bench"])):
        assert (ours.value, ours.low, ours.high) == pytest.approx(theirs[:3], rel=1e-9)
        assert ours.n == theirs[3]
    printed = [number(value) for key in ("own", "bench") for value in again[key][:3]]
    for one in printed:
        assert re.search(rf"(?<![\d.]){re.escape(one)}(?![\d.]*\d)", found.markdown)
    assert f"{again['own'][3]} pipelines that {again['studies']} studies used" in found.text
    assert [int(said.split()[0]) for said in found.left_out] == [n for n in again["lost"] if n]


def test_the_cost_of_drawn_constants_comes_out_the_same_by_another_way(
    published: Mapping[str, Finding], again: Mapping[str, Any]
) -> None:
    ratio, *_ = published["constants"].estimates
    assert [ratio.value, ratio.low, ratio.high] == pytest.approx(again["constants"][:3], rel=1e-9)
    assert (ratio.n, len(published["constants"].pairs)) == (again["constants"][3], again["pairs"])


def test_where_the_extractor_limits_noise_is_the_smaller_part(
    published: Mapping[str, Finding],
) -> None:
    """The title says so, whatever the record: what is left without noise is most of the error."""
    budgets = ERROR_BUDGET.read()
    led = [p for p in published["sources"].pairs if (p["extractor_share"] or 0.0) > 0.5]
    assert led
    for pair in led:
        row = budgets[pair["dataset"]]
        assert row["noise_deg"] ** 2 > 0.5 * row["as_is_deg"] ** 2


# ---- made up by hand


def record_of(
    errors: Errors,
    *,
    on_bench: Errors | None = None,
    bench_deg: float = 0.0,
    detectors: Mapping[str, str] | None = None,
    answered_deg: Mapping[tuple[str, str, str], float] | None = None,
) -> FindingsRecord:
    """A record of these errors by unit; `answered_deg` are errors without false Suns."""

    def cells(given: Errors) -> dict[Cell, UnitErrors]:
        return {Cell(d, "nominal", e, m): UnitErrors(tuple(v)) for (d, e, m), v in given.items()}

    rows = {
        Cell(d, "nominal", e, m): {
            "rms_all_answers_deg": values[0],
            "rms_deg": (answered_deg or {}).get((d, e, m), values[0]),
            "detector": (detectors or {}).get(d, "CMOS"),
            "mask": "Slit",
        }
        for (d, e, m), values in errors.items()
    }
    pins = {dataset: bench_deg for dataset, _, _ in errors}
    return FindingsRecord(rows, cells(errors), cells(on_bench or {}), pins, frozenset())


def study_of(*pipelines: tuple[str, str, str], basis: str = "stated") -> Resolution:
    """A study of these pipelines (data set, extractor, model)."""
    runs = tuple(
        SimpleNamespace(
            extractor=extractor,
            model=model,
            basis={"extractor": "stated", "model": basis},
            settings=(SimpleNamespace(dataset=dataset, condition="nominal"),),
        )
        for dataset, extractor, model in pipelines
    )
    return cast("Resolution", SimpleNamespace(pipelines=runs))


def test_a_pipeline_that_studies_share_counts_once_and_each_is_told_why_it_is_left_out() -> None:
    errors = {
        ("one", "bctm", "homography"): [0.01, 0.02],
        ("one", "bctm", "camera"): [0.02, 0.04],
        ("one", "bctm", "pinhole"): [0.04],
        ("one", "bctm", "spm"): [0.5],
        ("two", "bctm", "lsq"): [3.0],
        ("two", "bctm", "lut"): [0.1],
    }
    record = record_of(errors, bench_deg=0.02, answered_deg={("two", "bctm", "lsq"): 0.1})
    found = methods(
        record,
        {
            "A2001": study_of(("one", "bctm", "camera"), ("one", "bctm", "spm")),
            "B2002": study_of(("one", "bctm", "camera")),
            "C2003": study_of(("one", "bctm", "pinhole")),
            "Drawn": study_of(("one", "bctm", "spm")),
            "FalseSuns": study_of(("two", "bctm", "lsq")),
            "Ours": study_of(("two", "bctm", "lut"), basis="defaulted"),
            "Unmeasured": study_of(("two", "bctm", "polynomial-2d")),
        },
    )
    assert found.left_out == (
        "1 study without a score (Unmeasured)",
        "1 study whose error is mostly that of false detections (FalseSuns)",
        "1 study whose extractor or model we chose (Ours)",
        "1 study whose model has no fitted constant (Drawn)",
    )
    assert [(pair["model"], pair["studies"]) for pair in found.pairs] == [
        ("camera", ["A2001", "B2002"]),
        ("pinhole", ["C2003"]),
    ]
    # The pinhole is measured on the first unit alone, and compared there.
    assert [pair["ratio"] for pair in found.pairs] == pytest.approx([2.0, 4.0])
    alone = math.hypot(0.04, 0.02) / math.hypot(0.01, 0.02)
    assert [pair["bench_ratio"] for pair in found.pairs][1] == pytest.approx(alone)
    assert found.estimates[0].value == pytest.approx(3.0)
    assert found.estimates[0].n == 2


def test_a_data_set_counts_once_however_many_extractors_it_has() -> None:
    errors: dict[tuple[str, str, str], list[float]] = {}
    for extractor, drawn in (("a", 0.3), ("b", 0.4), ("c", 9.0)):
        errors["one", extractor, "spm"] = [drawn]
        errors["one", extractor, "pinhole"] = [0.06]
    errors |= {("two", "a", "spm"): [0.1], ("two", "a", "pinhole"): [0.2]}
    found = constants(record_of(errors, bench_deg=0.08))
    ratio, even = found.estimates
    assert ratio.n == 2
    # 0.06 deg on a bench of 0.08 deg is 0.1 deg; the middle extractor stands for the data set.
    assert ratio.value == pytest.approx((4.0 + 0.1 / math.hypot(0.2, 0.08)) / 2)
    assert even.value == pytest.approx((math.sqrt(0.4**2 - 0.06**2) + 0.0) / 2)
    assert "in 1 of 4 pairs" in found.text


def test_the_error_on_a_bench_is_compared_with_the_own_one_of_the_same_units() -> None:
    names = {f"c{n}": "CMOS" for n in range(6)} | {f"p{n}": "PD" for n in range(6)}
    errors = {(name, "e", "lut"): [0.03, 0.03] for name in names}
    worse = {place: [0.05 if names[place[0]] == "CMOS" else 0.0303] * 2 for place in errors}
    found = benches(record_of(errors, on_bench=worse, bench_deg=0.04, detectors=names))
    assert [one.value for one in found.estimates] == pytest.approx(
        [5 / 3, 1.01, math.hypot(3, 2) / 5, math.hypot(3, 2) / 5, (1.0 + 0.0303 / 0.05) / 2]
    )
    assert "and 1.0 % more for other detectors" in found.text


def curve(points: Sequence[tuple[int, float | None, float, int]], **more: Any) -> dict[str, Any]:
    named = ("poses", "middle_deg", "availability", "refused")
    return {
        "dataset": "d", "extractor": "e", "model": "m", "place": 1, "in_order": False,
        "floor_error_deg": 0.03, "bench_deg": 0.04, "poses": points[-1][0],
        "points": [dict(zip(named, point, strict=True)) for point in points], **more,
    }  # fmt: skip


def test_poses_are_counted_from_where_all_larger_subsets_are_near() -> None:
    points = [(4, None, 0.0, 6), (9, 0.03, 0.9, 1), (25, 0.037, 0.9, 0), (100, 0.032, 0.96, 0)]
    flight, never = curve(points, in_order=True), curve([(4, 0.9, 0.1, 0), (9, 0.9, 0.2, 0)])
    found = poses([curve(points), flight, curve(points, place=2), never])
    first, second = found.pairs
    # Within 10 % of 0.05 deg on the bench with 25 poses, of 0.03 deg without it with 100.
    assert (first["bench_poses"], first["own_poses"], first["answer_poses"]) == (25, 100, 100)
    assert (second["bench_poses"], second["own_poses"], second["answer_poses"]) == (None,) * 3
    assert found.estimates[0].value == math.inf
    assert found.estimates[0].row()["value"] is None
    assert found.left_out == ("1 flights, which have no choice of poses",)


def test_a_bias_is_what_the_true_places_remove() -> None:
    blank = dict.fromkeys(
        ("lamp_deg", "calibration_noise_deg", "noise_deg", "references_deg", "fixed_pattern_deg",
         "surroundings_deg", "perfect_dense_deg", "places_dense_deg", "bound_unit_deg")
    )  # fmt: skip
    row = {**blank, "extractor": "e", "model": "m", "rms_deg": 0.1, "as_is_deg": 0.1}
    budgets = {
        "biased": {**row, "bound_deg": 0.01, "perfect_deg": 0.08, "places_deg": 0.0},
        "noisy": {**row, "bound_deg": 0.09, "perfect_deg": 0.05, "places_deg": 0.0},
        "cells": {**row, "bound_deg": 0.05, "perfect_deg": 0.02, "places_deg": None},
    }
    architectures = {"biased": ("CMOS", "Lens"), "noisy": ("CCD", "Lens"), "cells": ("PD", "Slit")}
    found = sources(budgets, architectures)
    shares = {pair["dataset"]: pair["extractor_share"] for pair in found.pairs}
    assert shares == {"biased": pytest.approx(0.64), "noisy": pytest.approx(0.25), "cells": None}
    assert "on 1 of 2 data sets of array detectors: Lens 1 of 2." in found.title
    distance, near, biased = found.estimates
    assert distance.value == pytest.approx(2.0)
    assert near.value == pytest.approx(2 / 3)
    assert biased.value == 0.5
