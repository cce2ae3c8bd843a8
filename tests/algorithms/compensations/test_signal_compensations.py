"""Angular response, temperature and albedo taken out of photodiodes' signals."""

from __future__ import annotations

import numpy as np
import pytest

from algorithms.angles import separation_deg
from algorithms.compensations.electronics.angular_loss import KELLY, AngularLoss
from algorithms.compensations.environment.temperature import TemperatureDrift
from algorithms.compensations.interference.maximum_currents import MaximumCurrents
from algorithms.compensations.interference.sun_and_albedo_inputs import SunAndAlbedoInputs
from algorithms.compensations.interference.sun_and_earth import SunAndEarth
from algorithms.contract import UnusableDataError

CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
NORMALS = np.array(CUBE).T


def spread(count, seed=0):
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def kelly(cosines):
    c = np.maximum(cosines, 0.0)
    return np.maximum(KELLY[3] * c**3 + KELLY[2] * c**2 + KELLY[1] * c + KELLY[0], 0.0)


def test_kelly_is_inverted_where_it_says_anything():
    sun = spread(300)
    gains = np.array([1.0, 1.2, 0.8, 1.1, 0.9, 1.05])
    stage = AngularLoss(CUBE).fit(gains * kelly(sun @ NORMALS), sun)
    np.testing.assert_allclose(stage.gains_, gains * sum(KELLY), rtol=1e-12)
    asked = spread(500, seed=1)
    cosines = asked @ NORMALS
    found = stage.transform(gains * kelly(cosines))
    lit = cosines > 0.021
    np.testing.assert_allclose(found[lit], cosines[lit], atol=1e-9)
    assert np.abs(found[cosines < 0.019]).max() < 0.0201  # the printed cubic is zero there


def test_another_response_is_found_where_it_is_to_be_fitted():
    sun = spread(400)

    def response(c):
        return np.maximum(c, 0) * (1 + 0.3 * (1 - c))

    signals = 5.0 * response(sun @ NORMALS)
    found = AngularLoss(CUBE, response="fitted").fit(signals, sun)
    as_kelly = AngularLoss(CUBE).fit(signals, sun)
    cosines = np.maximum(sun @ NORMALS, 0)
    lit = cosines > 0.1
    assert np.abs(found.transform(signals) - cosines)[lit].max() < 1e-6
    assert np.abs(as_kelly.transform(signals) - cosines)[lit].max() > 0.05


def test_a_face_in_the_dark_is_named():
    sun = spread(200)
    sun = sun[sun[:, 2] > 0.2]
    with pytest.raises(UnusableDataError, match="face 6 is lit by 0"):
        AngularLoss(CUBE).fit(kelly(sun @ NORMALS), sun)


def warm(count, seed=5):
    return np.random.default_rng(seed).uniform(260.0, 340.0, count)


def test_each_faces_own_temperature_coefficient_is_found():
    sun, temperature = spread(600), warm(600)
    own = np.array([5e-4, 6e-4, 4e-4, 8e-4, 5e-4, 3e-4])
    reference = temperature.mean()
    signals = kelly(sun @ NORMALS) * (1 + own * (temperature - reference)[:, None])
    stage = TemperatureDrift(CUBE).fit(signals, sun, {"temperature_K": temperature})
    np.testing.assert_allclose(stage.coefficients_, own, atol=2e-6)
    asked, hot = spread(50, seed=2), np.full(50, 350.0)
    seen = kelly(asked @ NORMALS) * (1 + own * (350.0 - reference))
    np.testing.assert_allclose(
        stage.transform(seen, {"temperature_K": hot}), kelly(asked @ NORMALS), rtol=2e-4
    )


@pytest.mark.slow
def test_temperature_coefficients_lie_in_their_intervals():
    """93 to 97 % of 95 % intervals hold the true coefficient, over 200 seeds of noise."""
    sun, temperature = spread(300), warm(300)
    own = np.array([5e-4, 6e-4, 4e-4, 8e-4, 5e-4, 3e-4])
    clean = np.maximum(sun @ NORMALS, 0) * (1 + own * (temperature - temperature.mean())[:, None])
    held = []
    for seed in range(200):
        noisy = clean + np.random.default_rng(seed).normal(0, 2e-3, clean.shape)
        stage = TemperatureDrift(CUBE).fit(noisy, sun, {"temperature_K": temperature})
        held.append(np.abs(stage.coefficients_ - own) < 1.96 * stage.deviations_)
    assert 0.93 <= np.mean(held) <= 0.97


# Albedo


def with_earth(sun, nadir, strength=0.3):
    """Currents of a cube under the Sun and one vector of albedo from the nadir."""
    share = ((1 - (sun * nadir).sum(axis=1)) / 2) ** 2
    earth = strength * share[:, None] * nadir
    return np.maximum(sun @ NORMALS, 0) + np.maximum(earth @ NORMALS, 0)


def sun_of(signals):
    vector = signals[:, ::2] - signals[:, 1::2]
    return vector / np.linalg.norm(vector, axis=1, keepdims=True)


def test_the_brighter_face_of_a_pair_is_kept():
    stage = MaximumCurrents(CUBE).fit(np.maximum(spread(50) @ NORMALS, 0), spread(50))
    sun, nadir = spread(400, seed=7), spread(400, seed=8)
    seen = with_earth(sun, nadir)
    kept = stage.transform(seen)
    pairs = kept.reshape(-1, 3, 2)
    assert (pairs.min(axis=2) == 0).all()
    np.testing.assert_allclose(pairs.max(axis=2), seen.reshape(-1, 3, 2).max(axis=2), rtol=1e-12)
    assert np.median(separation_deg(sun_of(kept), sun)) < np.median(
        separation_deg(sun_of(seen), sun)
    )


def test_the_earths_share_is_learnt_and_taken_off():
    sun, nadir = spread(400), spread(400, seed=1)
    stage = SunAndEarth(CUBE).fit(with_earth(sun, nadir), sun, {"nadir": nadir})
    assert stage.albedo_ == pytest.approx(0.3, rel=0.02)
    asked, below = spread(300, seed=2), spread(300, seed=3)
    found = stage.transform(with_earth(asked, below), {"nadir": below})
    assert np.sqrt(np.mean(separation_deg(sun_of(found), asked) ** 2)) < 0.3
    raw = separation_deg(sun_of(with_earth(asked, below)), asked)
    assert np.sqrt(np.mean(raw**2)) > 4


def context_of(sun, field):
    return {
        "magnetic_field_nT": 4e4 * field,
        "sun_inertial": sun,
        "magnetic_field_inertial_nT": 3e4 * field,
    }


def test_up_to_two_shared_faces_are_told_apart():
    """Frezza2022's types: as many faces as Sun and Earth both light, noise-free."""
    sun, nadir, field = spread(3000), spread(3000, seed=1), spread(3000, seed=2)
    stage = SunAndAlbedoInputs(CUBE, tolerance=0.005)
    stage.fit(np.maximum(sun @ NORMALS, 0), sun, context_of(sun, field))
    seen = with_earth(sun, nadir)
    share = 0.3 * ((1 - (sun * nadir).sum(axis=1)) / 2) ** 2
    earth = share[:, None] * nadir
    clear = (np.abs(sun) > 0.02).all(axis=1) & (np.abs(earth) > 0.02).all(axis=1)
    shared = ((sun > 0) == (earth > 0)).sum(axis=1)
    error = separation_deg(sun_of(stage.transform(seen, context_of(sun, field))), sun)
    for kind, answered in ((0, 0.5), (1, 0.35), (2, 0.3)):
        chosen = error[clear & (shared == kind)]
        found = chosen[np.isfinite(chosen)]
        assert len(found) > answered * len(chosen), kind
        assert np.median(found) < 1e-9, kind
        assert (found < 1.0).mean() > 0.97, kind


def test_three_shared_faces_have_no_solution():
    sun = np.full((1, 3), 3**-0.5)
    field = spread(1)
    stage = SunAndAlbedoInputs(CUBE).fit(
        np.maximum(spread(60) @ NORMALS, 0), spread(60), context_of(spread(60), spread(60))
    )
    alone = np.maximum(sun @ NORMALS, 0)
    np.testing.assert_allclose(stage.transform(alone, context_of(sun, field)), alone, rtol=1e-9)
    both = alone + 0.1 * (alone > 0)
    assert np.isnan(stage.transform(both, context_of(sun, field))).all()
