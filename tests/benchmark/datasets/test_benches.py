"""Drawn benches against their stated sizes, and what a board states once."""

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.benches import aligned_bench_deg, report
from benchmark.datasets.controls import board_facts, oracle
from benchmark.datasets.corrected import (
    correct,
    correction,
    corrections,
    reference_condition,
)
from benchmark.metrics.separation import separation_deg


@pytest.fixture(scope="module")
def slit():
    return datasets.get("pda-slit")


def test_benches_err_as_stated_over_many_draws_and_each_draw_is_its_own(slit):
    sun = slit.generate("nominal", "test", 100).sun
    errors = [separation_deg(report(slit, "nominal", sun, k), sun) for k in range(150)]
    stated = np.hypot(slit.reference_error_deg("nominal"), np.sqrt(2) * 0.003)
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(stated, rel=0.1)
    assert len({round(float(np.mean(e)), 9) for e in errors}) == 150
    again = report(slit, "nominal", sun, 7)
    np.testing.assert_array_equal(again, report(slit, "nominal", sun, 7))
    other = report(slit.for_unit(3), "nominal", sun, 7)
    assert (again != other).any()


def test_alignment_leaves_what_is_no_rotation(slit):
    """Mounting is a rotation and half of the fixed error's square or more."""
    sun = slit.generate("nominal", "test").sun
    left = aligned_bench_deg(slit, "nominal", sun)
    assert 0.0 < left < 0.7 * slit.reference_error_deg("nominal")
    aboard = datasets.get("pd-orbit")
    assert aligned_bench_deg(aboard, "nominal", sun) == pytest.approx(0.0, abs=1e-9)


def test_a_perfect_calibration_has_no_bench():
    cube = datasets.get("pd-maskless-cube")
    sun = cube.generate("ideal-calibration", "test", 30).sun
    np.testing.assert_array_equal(report(cube, "ideal-calibration", sun, 0), sun)
    assert aligned_bench_deg(cube, "ideal-calibration", sun) == 0.0


def test_the_controls_are_the_bound_s_noise_and_the_angle_off_boresight(slit):
    samples, bound = slit.generate("nominal", "test"), slit.bound("nominal", "test")
    facts = board_facts(slit, "nominal", samples.sun, bound)
    angle = bound.angle_deg[bound.observable]
    assert facts["oracle_deg"] == pytest.approx(np.sqrt(np.mean(angle**2)), rel=0.1)
    off = np.degrees(np.arccos(samples.sun[bound.observable, 2]))
    assert facts["boresight_deg"] == pytest.approx(np.sqrt(np.mean(off**2)), rel=1e-4)
    assert facts["bench_deg"] == pytest.approx(slit.reference_error_deg("nominal"), rel=1e-4)
    answers = oracle(slit, "nominal", samples.sun, bound)
    np.testing.assert_allclose(np.linalg.norm(answers, axis=1), 1.0)


def test_a_sensor_that_was_calibrated_as_nominal_shares_the_nominal_references(slit):
    names = ("albedo", "misaligned", "hot", "hot-renewed", "hot-recalibrated")
    assert [reference_condition(slit, name) for name in names] == [
        *("nominal" for _ in range(4)),
        "hot-recalibrated",
    ]


def test_renewed_references_take_away_what_warmth_brings(slit):
    """Without them a hot detector's dark signal stays in what is corrected."""
    left = {}
    for name in ("hot", "hot-renewed"):
        by = corrections(slit, name)
        assert by["calibration"] is not None
        samples = slit.generate(name, "test", 20)
        left[name] = np.median(correct(by["test"], samples).observations)
    hot = slit.setups["hot"].sensor.detector
    grown = hot.dark.level() - slit.setups["nominal"].sensor.detector.dark.level()
    assert left["hot"] == pytest.approx(grown * hot.exposure_s / hot.gain_e_per_dn, rel=0.05)
    assert abs(left["hot-renewed"]) < 0.02 * left["hot"]


def test_correction_takes_away_the_pattern_that_units_differ_by(slit):
    """Of two units under one light the corrected readings are alike but for noise."""
    raw, ready = [], []
    for number in (1, 2):
        unit = slit.for_unit(number)
        samples = unit.generate("hot-recalibrated", "test", 20)
        raw.append(np.asarray(samples.observations, dtype=float))
        ready.append(correct(correction(unit, "hot-recalibrated"), samples).observations)
    # most pixels are in the dark: over the samples each reads its own dark signal
    size = [np.median(np.abs(np.median(one - two, axis=0))) for one, two in (raw, ready)]
    assert size[1] < 0.5 * size[0]
