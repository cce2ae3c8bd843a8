"""Hot sensors that were calibrated at 25 deg C: the record against a script of its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from algorithms.pipeline import Pipeline
from benchmark import datasets
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.leaderboard.scope import SINCE
from benchmark.plan.parts import installed_parts
from benchmark.results.store import PUBLISHED, Store

#: Errors of the leader when tested hot, degrees, by a review that calibrated at 25 deg C itself.
REVIEWED = {
    "psd-single-aperture": 2.79,
    "pd-maskless-pyramid": 4.13,
    "pd-slit": 6.6,
    "ccd-slit": 0.0108,
    "cmos-single-aperture": 0.0111,
}
FURTHER = (
    *("ccd-single-aperture", "ccd-v-slit", "cmos-slit", "pda-slit", "pda-n-slit", "ccd-n-slit"),
    *("cmos-n-slit", "pd-single-aperture", "ltf-maskless-cube", "oi-maskless-pyramid"),
    *("pd-code-dial", "cmos-single-aperture-pinhole"),
)


def leader(dataset: str) -> dict[str, Any]:
    """Return the row in the record of what leads a data set, under the condition ``hot``."""
    rows = Store(PUBLISHED).rows()
    of_it = [row for row in rows if row["dataset"] == dataset]
    hot = {(r["extractor"], r["model"]): r for r in of_it if r["condition"] == "hot"}
    ranked = [
        row
        for row in of_it
        if row["condition"] == "nominal"
        and row["rms_all_answers_deg"]
        and row["availability"] > 0.95
        and (row["extractor"], row["model"]) in hot
    ]
    best = min(ranked, key=lambda row: row["rms_all_answers_deg"])
    return dict(hot[best["extractor"], best["model"]])


def calibrated_cold_tested_hot(dataset: str, extractor: str, model: str) -> float:
    """Return the error, degrees, of poses at 25 deg C and readings at 80, one dark for both."""
    preset, parts = datasets.get(dataset), installed_parts()
    reader = parts.extractor(extractor).for_sensor(preset.geometry)
    fitted = parts.model(model).for_sensor(preset.geometry, reader.about.kind)
    by = correction(preset, "nominal")
    poses = preset.generate("nominal", "calibration")
    warm = preset.generate("hot-recalibrated", "test")
    pipeline = Pipeline(reader, fitted)
    pipeline.fit_features(features_of(reader, poses, by), np.asarray(poses.truth), poses.context)
    answers = pipeline.predict_features(features_of(reader, warm, by), warm.context)
    seen = np.isfinite(answers).all(axis=1) & preset.bound("hot", "test").observable
    cosine = np.clip(np.sum(answers[seen] * warm.sun[seen], axis=1), -1.0, 1.0)
    cross = np.linalg.norm(np.cross(answers[seen], warm.sun[seen]), axis=1)
    return float(np.sqrt(np.mean(np.degrees(np.arctan2(cross, cosine)) ** 2)))


@pytest.mark.parametrize(
    "dataset",
    [pytest.param(one, marks=[pytest.mark.slow] * one.startswith("c")) for one in REVIEWED],
)
def test_a_sensor_that_got_hot_errs_as_a_script_of_its_own_finds(dataset: str) -> None:
    row = leader(dataset)
    found = calibrated_cold_tested_hot(dataset, row["extractor"], row["model"])
    assert row["rms_deg"] == pytest.approx(found, rel=0.05)
    assert found == pytest.approx(REVIEWED[dataset], rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("dataset", FURTHER)
def test_twelve_more_agree_with_the_record(dataset: str) -> None:
    row = leader(dataset)
    found = calibrated_cold_tested_hot(dataset, row["extractor"], row["model"])
    assert row["rms_deg"] == pytest.approx(found, rel=0.05)


def test_leaders_are_scored_on_ten_units_after_their_calibration() -> None:
    units: dict[tuple[str, str], set[int]] = {}
    for row in Store(PUBLISHED).rows(unit=None):
        if row["condition"] in SINCE:
            units.setdefault((row["dataset"], row["condition"]), set()).add(row["unit"])
    assert len(units) > 90
    assert {len(found) for found in units.values()} == {10}
