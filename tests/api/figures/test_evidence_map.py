"""The evidence map's five states against sets of studies, scores and what extractors read."""

from __future__ import annotations

import math
from collections import defaultdict
from functools import cache
from typing import Any

import pytest

from api.figures.catalogue import evidence_map
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark.results.store import PUBLISHED, Store
from registry.catalogue import catalogue
from registry.evidence import Evidence, PipelineRun
from registry.fitting import stages
from registry.possibility import GIVES, TELLS
from registry.studies import facts
from tests.api.figures.conftest import Values, studies_with


@pytest.fixture(scope="module")
def measurements(knowledge: Knowledge) -> Measurements:
    return knowledge.measurements


@pytest.fixture(scope="module")
def evidence(knowledge: Knowledge) -> Evidence:
    return knowledge.evidence


def place(row: Any) -> tuple[str, str, str]:
    return row["dataset"], row["extractor"], row["model"]


@pytest.fixture(scope="module")
def own_errors(measurements: Measurements) -> dict[tuple[str, str, str], float]:
    """Geometric mean over units of the error under the first condition, in five digits."""
    units: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    for row in Store(PUBLISHED).rows(unit=None):
        first = measurements.presets[row["dataset"]].conditions[0]
        if row["condition"] == first and row["rms_all_answers_deg"]:
            units[place(row)].append(row["rms_all_answers_deg"])
    means = {key: math.exp(sum(map(math.log, of)) / len(of)) for key, of in units.items()}
    return {key: float(f"{mean:.5g}") for key, mean in means.items()}


@pytest.mark.parametrize(
    ("rows", "columns"),
    [
        ("detector", "mask"),
        pytest.param("detector", "extractor", marks=pytest.mark.slow),
        pytest.param("mask", "model", marks=pytest.mark.slow),
    ],
)
def test_each_pair_is_in_the_state_that_sets_of_studies_and_scores_say(
    rows: str,
    columns: str,
    *,
    values: Values,
    sensors: dict[str, set[tuple[str, str]]],
    evidence: Evidence,
    measurements: Measurements,
    own_errors: dict[tuple[str, str, str], float],
) -> None:
    """Independent: studies from the files, scores from the rows of the record."""
    presets = measurements.presets
    own = catalogue()
    extracted = cache(lambda name: own.extractor(name).about.taxonomy)
    staged = cache(lambda name: set(stages(own.model(name))))
    meant = cache(lambda value: set(facts().taxonomy.kinds("model", value)))

    def has(row: Any, level: str, value: str) -> bool:
        if level in ("detector", "mask"):
            return bool(getattr(presets[row["dataset"]], level) == value)
        if level == "extractor":
            return bool(extracted(row["extractor"]) == value)
        return not meant(value).isdisjoint(staged(row["model"]))

    scores = [score for score in measurements.nominal.values() if score["rms_deg"] is not None]
    for row in evidence_map(facts(), {}, rows, columns, evidence=evidence).rows:
        pair = (rows, row["row"]), (columns, row["column"])
        scored = [score for score in scores if all(has(score, *value) for value in pair)]
        assert row["pipelines"] == len(scored)
        unknown = {
            key
            for key, of in values.items()
            for (level, value), other in (pair, pair[::-1])
            if value in of[level] and not of[other[0]]
        }
        assert set(row["unknown"]) == unknown
        assert row["count"] == len(studies_with(values, sensors, *pair))
        assert (row["state"] == "measured") == bool(scored)
        if row["state"] == "studied":
            assert row["count"]
        if row["state"] in ("impossible", "unknown", "unstudied"):
            assert not row["count"]
            assert (row["state"] == "impossible") == bool(row["reason"])
        if row["state"] == "unknown":
            assert unknown
        if row["state"] == "unstudied":
            assert not unknown
        if scored and row["best_own_error_deg"] is not None:
            assert row["best_own_error_deg"] == pytest.approx(
                min(own_errors[place(score)] for score in scored if score["availability"] >= 0.95)
            )


def test_every_data_set_gives_readings_that_its_detector_gives_and_its_mask_lets_tell(
    measurements: Measurements,
) -> None:
    for preset in measurements.presets.values():
        assert str(preset.observation) in GIVES[preset.detector]
        assert str(preset.observation) in TELLS.get(preset.mask, {str(preset.observation)})
    assert set(GIVES) == set(facts().taxonomy.values("detector"))


def test_pairs_that_no_extractor_can_read_are_impossible_where_no_study_has_them(
    evidence: Evidence,
) -> None:
    found = {
        (row["row"], row["column"]): row
        for row in evidence_map(facts(), {}, "detector", "extractor", evidence=evidence).rows
    }
    assert found["CMOS", "Voltage balance"]["state"] == "impossible"
    assert found["QPD", "BCTM"]["state"] == "impossible"
    assert "QPD gives currents" in found["QPD", "BCTM"]["reason"]
    assert found["Event", "ESCM"]["state"] == "measured"
    against = {
        pair: row["studies"] for pair, row in found.items() if row["reason"] and row["count"]
    }
    # Merchan2023 has both an event sensor's method and CMOS; Post2013 two sensors.
    assert against == {("CMOS", "ESCM"): ["Merchan2023"], ("PVA", "BCTM"): ["Post2013"]}


def test_what_can_be_scored_and_was_not_tried_is_named_for_both_its_values() -> None:
    plan = {("CMOS", "Single-Ap."): {("bcm", "spm"): ("cmos-single-aperture",)}}
    run = PipelineRun("cmos-single-aperture", "bcm", "spm")
    untried = Evidence(catalogue(), (), plan)
    for pair in (
        (("detector", "CMOS"), ("mask", "Single-Ap.")),
        (("mask", "Single-Ap."), ("model", "SPM")),
        (("extractor", "BCM"), ("model", "SPM")),
    ):
        assert untried.of(*pair, (), ()).possible_run == run
    elsewhere = untried.of(("detector", "CCD"), ("model", "SPM"), (), ())
    assert (elsewhere.possible_run, elsewhere.nearest_dataset) == (None, "cmos-single-aperture")
