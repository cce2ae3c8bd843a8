"""QPD with a gap: against areas summed chord by chord, and the survey's own compensation."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.calibration.forward import inward
from algorithms.contract import FeatureKind, SensorGeometry, UnusableDataError
from algorithms.models.geometric.quadrant_gap import QuadrantGap, corner_area
from algorithms.models.geometric.standard_projection import StandardProjection

HEIGHT, WIDTH, GAP = 1.03, 2.0, 0.2
#: Focal length, centre (x, y), rotation, tilts, and of a round aperture the gap.
TRUTH = (HEIGHT, 0.05, -0.04, 0.5, 1.0, -0.7, 0.12)


def field(limit_deg=35.0, steps=11):
    axis = np.linspace(-limit_deg, limit_deg, steps)
    return sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))


def chord(y, spot, from_x, to_x):
    """Length of a round spot's chords at y (M,) between two x."""
    half = np.sqrt(np.maximum((WIDTH / 2) ** 2 - (y - spot[1]) ** 2, 0.0))
    return np.maximum(np.minimum(spot[0] + half, to_x) - np.maximum(spot[0] - half, from_x), 0.0)


def lit_areas(spot, gap, steps=8_000):
    """Areas lit on Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y)."""
    far, areas = 10.0, []
    for way_x, way_y in ((-1, 1), (1, 1), (1, -1), (-1, -1)):
        x = sorted((way_x * gap / 2, way_x * far))
        low, high = sorted((way_y * gap / 2, way_y * far))
        low = np.clip(low, spot[1] - WIDTH / 2, spot[1] + WIDTH / 2)
        high = np.clip(high, spot[1] - WIDTH / 2, spot[1] + WIDTH / 2)
        # finer strips at both ends, where the rim's chords grow like roots
        turn = np.linspace(0, np.pi, steps)
        edges = low + (high - low) * (1 - np.cos(turn)) / 2
        y = (edges[1:] + edges[:-1]) / 2
        areas.append(float((chord(y, spot, *x) * np.diff(edges)).sum()))
    return np.array(areas)


def balances_of(areas):
    q1, q2, q3, q4 = np.asarray(areas).T
    total = q1 + q2 + q3 + q4
    return np.column_stack([(q2 + q3 - q1 - q4) / total, (q1 + q2 - q3 - q4) / total])


def test_a_round_spot_is_found_from_areas_summed_chord_by_chord():
    sun = field(33.0, 9)
    spots = HEIGHT * sun[:, :2] / sun[:, 2:] + (0.05, -0.04)
    balances = balances_of([lit_areas(spot, GAP) for spot in spots])
    model = QuadrantGap(1.0, WIDTH, "round").fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-4  # of the sums' own error
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    assert found["gap"] == pytest.approx(GAP, abs=1e-5)
    assert found["focal_length"] == pytest.approx(HEIGHT, abs=1e-5)
    assert (found["centre_x"], found["centre_y"]) == pytest.approx((0.05, -0.04), abs=1e-4)


def test_light_of_the_gap_added_gives_the_balance_of_the_whole_spot():
    """eq:gapcomp with k_G = 1: gap areas times signals over lit areas, a piece to its half."""
    spot, light = np.array([0.3, -0.2]), 7.0
    lit, whole = lit_areas(spot, GAP), lit_areas(spot, 0.0)
    signals = light * lit
    gaps = (whole - lit) * signals.sum() / lit.sum()
    np.testing.assert_allclose(
        balances_of((signals + gaps)[None]), balances_of(whole[None]), atol=1e-12
    )
    shape = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    model = QuadrantGap(1.0, WIDTH, "round")
    np.testing.assert_allclose(
        model.cast(shape, spot[None]), balances_of((signals + gaps)[None]), atol=1e-7
    )


@pytest.mark.parametrize("shape", ["round", "square"])
def test_a_noiseless_sensor_is_inverted_and_its_numbers_found(shape):
    truth = np.array(TRUTH if shape == "round" else TRUTH[:-1])
    model = QuadrantGap(1.0, WIDTH, shape, gap_mm=0.0 if shape == "round" else 0.12)
    sun = field()
    balances = model.cast(truth, inward(sun, model.turns(truth)))
    model.fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-6
    np.testing.assert_allclose(model.vector_, truth, atol=1e-7)


def test_behind_a_square_aperture_gap_and_focal_length_are_one():
    """The balance is 2 X / (d - gap): any gap, with the focal length to it, tells as much."""
    sun = field()
    x = HEIGHT * sun[:, :2] / sun[:, 2:]
    balances = 2 * x / (WIDTH - GAP)
    for drawn in (0.0, 0.3):
        model = QuadrantGap(1.0, WIDTH, "square", gap_mm=drawn).fit(balances, sun)
        assert separation_deg(model.predict(balances), sun).max() < 1e-9
        focal = model.quality_.parameter("focal_length").value
        assert focal == pytest.approx(HEIGHT * (WIDTH - drawn) / (WIDTH - GAP))


def test_a_gap_that_is_not_known_of_bends_the_answer():
    sun = field(30.0, 9)
    model = QuadrantGap(HEIGHT, WIDTH, "round")
    balances = model.cast(np.array([HEIGHT, 0, 0, 0, 0, 0, GAP]), sun[:, :2] / sun[:, 2:])
    straight = StandardProjection(HEIGHT, WIDTH / 2).fit(balances, sun)
    assert straight.quality_.residual_rms_deg > 1.0
    assert model.fit(balances, sun).quality_.residual_rms_deg < 1e-9


def test_all_light_on_one_half_says_no_direction():
    sun = field()
    model = QuadrantGap(1.0, WIDTH, "round", extrapolation=np.inf)
    model.fit(model.cast(np.array([*TRUTH[:3], 0, 0, 0, 0.1]), sun[:, :2] / sun[:, 2:]), sun)
    found = model.predict([[1.0, 0.0], [0.0, -1.0], [0.3, 0.3], [1.2, 0.0]])
    assert np.isnan(found).all(axis=1).tolist() == [True, True, False, True]


@pytest.mark.slow
def test_intervals_hold_the_truth_as_often_as_they_say(coverage_of):
    model, sun = QuadrantGap(1.0, WIDTH, "round"), field(steps=7)
    balances = model.cast(np.array(TRUTH), inward(sun, model.turns(np.array(TRUTH))))
    assert 0.93 <= coverage_of(model, balances, sun, TRUTH) <= 0.97


def test_corner_areas_of_a_disc_add_up():
    a, b = np.random.default_rng(0).uniform(-1.3, 1.3, (2, 500))
    both, nowhere = corner_area(a, b), np.full(500, -1.0)
    neither = np.pi - corner_area(a, nowhere) - corner_area(nowhere, b) + both
    np.testing.assert_allclose(neither, corner_area(-a, -b), atol=1e-12)  # the disc, turned round
    np.testing.assert_allclose(both, corner_area(b, a), atol=1e-12)


def test_poses_and_drawings_that_do_not_settle_it_are_refused():
    sun = field()
    model = QuadrantGap(1.0, WIDTH, "round")
    balances = model.cast(np.array(TRUTH), sun[:, :2] / sun[:, 2:])
    for rows in (np.arange(3), np.zeros(60, dtype=int), np.abs(sun[:, 0]) < 1e-12):
        with pytest.raises(UnusableDataError, match="qpd"):
            model.fit(balances[rows], sun[rows])
    drawn = SensorGeometry(
        focal_length_mm=1.0, aperture_width_mm=WIDTH, aperture_shape="round", gap_mm=0.05
    )
    assert QuadrantGap.for_sensor(drawn, FeatureKind.BALANCE).gap_mm == 0.05
