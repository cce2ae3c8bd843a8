"""What networks are held against: orbits and units not trained on, an albedo model, nothing."""

from __future__ import annotations

import numpy as np
import pytest

from benchmark import datasets
from benchmark.assessment import networks
from benchmark.datasets.conditions.flight import FlightPreset

PRESET = datasets.get(networks.ALBEDO_ORBIT)


def flight():
    assert isinstance(PRESET, FlightPreset)
    return PRESET.flight


@pytest.fixture(scope="module")
def parts():
    return networks.parts(PRESET, "nominal")


def thinned(part):
    """Every eighth sample."""
    rows = slice(None, None, 8)
    context = {name: np.asarray(column)[rows] for name, column in part.context.items()}
    return networks.Part(part.features[rows], part.sun[rows], context, part.lit[rows])


def test_training_is_a_day_of_orbits_and_the_test_others_a_week_on():
    calibration, test = flight().calibration, flight().test
    trained_s, period_s = calibration.samples * calibration.step_s, flight().orbit.period_s
    assert trained_s == 86_400.0
    assert trained_s / period_s == pytest.approx(14.9, abs=0.1)
    assert test.samples * test.step_s / period_s == pytest.approx(3.0, abs=0.01)
    assert test.start_day * 86_400.0 > trained_s


def test_the_sun_stays_in_the_field_of_the_four_photodiodes(parts):
    reach = np.cos(np.radians(PRESET.geometry.half_fov_deg))
    for part in parts:
        assert part.features.shape[1] == 4
        assert part.sun[:, 2].min() > reach


def test_an_albedo_model_takes_off_what_no_correction_leaves(parts):
    """The simulator's own Earth at a nadir half a degree off: a tenth of the error stays."""
    known, asked = (thinned(part) for part in parts)
    rms = {}
    for method in ("no correction", "albedo model"):
        found = networks.METHODS[method](PRESET.geometry, known, asked)
        rms[method] = networks._measure("orbits", "", method, found, asked).rms_deg
    assert rms["albedo model"] < 0.2 * rms["no correction"]
    assert 1.0 < rms["no correction"] < 10.0  # degrees: what Soken2023 and Sozen2021 speak of


@pytest.mark.slow
def test_a_network_answers_where_it_was_trained_and_nowhere_else():
    """On a mask of many spots: where all of them are seen, or wherever some are."""
    found = {(one.method, one.case): one for one in networks.fields()}
    assert set(found) == {
        (f"ann, {mode}", case)
        for mode in ("S-FOV", "X-FOV")
        for case in ("all spots", "some spots")
    }
    assert found["ann, S-FOV", "some spots"].answered == 0.0
    assert found["ann, X-FOV", "all spots"].answered == 1.0
    assert found["ann, X-FOV", "some spots"].answered == 1.0
    assert found["ann, X-FOV", "some spots"].rms_deg < 0.01


@pytest.mark.slow
def test_every_method_is_tried_on_orbits_that_it_was_not_calibrated_on():
    found = list(networks.orbits(conditions=["nominal"]))
    assert [one.method for one in found] == list(networks.METHODS)
    assert {(one.question, one.case) for one in found} == {("orbits", "nominal")}
    assert all(one.answered > 0.5 for one in found)
