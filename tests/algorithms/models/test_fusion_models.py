"""Pyramidal, Panoramic and Solar panel against closed forms and NumPy's own least squares."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.models.geometric.panoramic import WeightedCells
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.geometric.solar_panel import SolarPanels

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


def survey_pyramid(count, tilt_deg, first_deg=0.0):
    """Rows of eq:msfpyra1: azimuths from +y towards +x, elevation gamma of the normals."""
    azimuth = np.radians(first_deg + 360 / count * np.arange(count))
    gamma = np.radians(90 - tilt_deg)
    return np.column_stack(
        [
            np.sin(azimuth) * np.cos(gamma),
            np.cos(azimuth) * np.cos(gamma),
            np.full(count, np.sin(gamma)),
        ]
    )


def as_design(normals):
    return tuple(tuple(row) for row in np.asarray(normals, dtype=float).tolist())


def direction(off_deg, turn_deg):
    off, turn = np.radians([off_deg, turn_deg])
    return np.array([[np.sin(off) * np.cos(turn), np.sin(off) * np.sin(turn), np.cos(off)]])


def spread(count, seed=0):
    vectors = np.random.default_rng(seed).standard_normal((count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def cosines(sun, normals):
    return np.maximum(sun @ np.asarray(normals, dtype=float).T, 0.0)


# Pyramidal


@settings(deadline=None, derandomize=True)
@given(
    count=st.integers(3, 12),
    tilt=st.floats(5, 80),
    first=st.floats(0, 360),
    share=st.floats(0, 0.95),
    turn=st.floats(0, 360),
    light=st.floats(1e-3, 1e6),
    seed=st.integers(0, 99),
)
def test_pyramid_inverts_cosine_faces_while_all_are_lit(
    *, count, tilt, first, share, turn, light, seed
):
    normals = np.random.default_rng(seed).permutation(survey_pyramid(count, tilt, first))
    sun = direction(share * (90 - tilt), turn)
    signals = light * cosines(sun, normals)
    model = RegularPyramid(as_design(normals), dark_fraction=1e-4, extrapolation=math.inf).fit(
        signals, sun
    )
    assert separation_deg(model.predict(signals), sun).max() < 1e-9
    assert model.coefficients_ == pytest.approx(np.full(count, 1 / light))


def test_pyramid_follows_the_corrected_equation():
    """eq:msfpyra2 with its own symbols: b_x, b_y and b_z, a row each, on signals that fit none."""
    b = survey_pyramid(5, 33.0, 12.0)
    e = np.random.default_rng(3).uniform(0.5, 1.0, 5)
    matrix = np.vstack([column / (column @ column) for column in b.T])
    expected = matrix @ e
    model = RegularPyramid(as_design(b), extrapolation=math.inf).fit(e[None], [[0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        model.predict(e[None])[0], expected / np.linalg.norm(expected), atol=1e-15
    )
    # and the three rows are least squares over all faces
    np.testing.assert_allclose(np.linalg.lstsq(b, e)[0], expected, atol=1e-14)


@settings(deadline=None, derandomize=True)
@given(st.floats(0, 2), st.floats(0, 50), st.floats(0, 360))
def test_light_on_all_faces_alike_moves_the_pyramids_vector_along_z_only(constant, off, turn):
    tilt = 30.0
    normals, sun = survey_pyramid(6, tilt), direction(off, turn)
    model = RegularPyramid(as_design(normals), extrapolation=math.inf).fit(
        cosines(sun, normals), sun
    )
    found = model.predict(cosines(sun, normals) + constant)
    expected = sun + np.array([0, 0, constant / np.cos(np.radians(tilt))])
    assert separation_deg(found, expected).max() < 1e-9


def test_pyramid_gives_nothing_where_a_face_is_dark():
    normals = survey_pyramid(4, 30.0)
    lit = np.array([[0.9, 0.8, 0.7, 0.6]])
    model = RegularPyramid(as_design(normals), extrapolation=math.inf).fit(lit, [[0.0, 0.0, 1.0]])
    rows = np.array(
        [[0.9, 0.8, 0.7, 0.0091], [0.9, 0.8, 0.7, 0.0089], [0.9, 0.8, 0.7, 0], [0] * 4, [-1] * 4]
    )
    assert np.isnan(model.predict(rows)).all(axis=1).tolist() == [False, True, True, True, True]
    with pytest.raises(ValueError, match="every face lit"):
        model.fit(rows[1:], np.tile([0.0, 0.0, 1.0], (4, 1)))
    with pytest.raises(ValueError, match="towards the Sun"):
        model.fit(lit, [[0.0, 0.0, -1.0]])


def test_a_coefficient_a_face_makes_up_for_gains_one_in_common_does_not():
    normals = survey_pyramid(6, 30.0)
    sun = np.vstack([direction(off, turn) for off in (10, 30, 50) for turn in range(0, 360, 17)])
    gains = np.array([1.3, 0.8, 1.0, 0.7, 1.1, 0.9])
    signals = gains * cosines(sun, normals)
    each = RegularPyramid(as_design(normals), coefficient="each").fit(signals, sun)
    common = RegularPyramid(as_design(normals)).fit(signals, sun)
    assert each.coefficients_ == pytest.approx(1 / gains)
    assert separation_deg(each.predict(signals), sun).max() < 1e-9
    assert np.nanmax(separation_deg(common.predict(signals), sun)) > 5


@pytest.mark.parametrize(
    "normals",
    [
        FACES,
        survey_pyramid(6, 30.0)[:5],  # a face missing
        survey_pyramid(4, 90.0),  # a prism
        -survey_pyramid(4, 30.0),
        survey_pyramid(4, 30.0) * 1.1,
        survey_pyramid(3, 30.0)[:2],
        np.vstack([survey_pyramid(3, 30.0), survey_pyramid(3, 40.0, 60.0)]),
        (),
    ],
)
def test_pyramid_refuses_faces_of_another_body(normals):
    with pytest.raises(ValueError, match="pyramidal needs"):
        RegularPyramid.for_sensor(
            SensorGeometry(face_normals=as_design(normals)), FeatureKind.SIGNALS
        )


# Panoramic


def weighted_least_squares(normals, signals, weights):
    """Oracle: rows scaled by the root of their weight, then NumPy's least squares."""
    scale = np.sqrt(weights)
    solution = np.linalg.lstsq(scale[:, None] * normals, scale * signals)[0]
    return solution / np.linalg.norm(solution)


@settings(deadline=None, derandomize=True)
@given(st.integers(0, 10_000), st.integers(4, 30), st.sampled_from(["signal", "equal"]))
def test_panoramic_is_weighted_least_squares_over_the_lit_cells(seed, count, weighting):
    rng = np.random.default_rng(seed)
    normals, sun = spread(count, seed), spread(300, seed + 1)
    reference = rng.uniform(0.5, 2.0, count)
    model = WeightedCells(as_design(normals), weighting=weighting, extrapolation=math.inf)
    model.fit(reference * cosines(sun, normals), sun)
    np.testing.assert_allclose(model.reference_, reference, rtol=1e-12)

    noisy = np.maximum(cosines(sun[:20], normals) + rng.normal(0, 0.05, (20, count)), 0)
    found = model.predict(reference * noisy)
    for row, vector in zip(noisy, found, strict=True):
        lit = row >= np.cos(np.radians(75))
        shares = row[lit] if weighting == "signal" else np.ones(lit.sum())
        values = np.linalg.svd(normals[lit] * np.sqrt(shares)[:, None], compute_uv=False)
        if lit.sum() < 3:
            assert np.isnan(vector).all()
        elif values[-1] > 0.05 * values[0]:
            expected = weighted_least_squares(normals[lit], row[lit], shares)
            assert vector == pytest.approx(expected, abs=1e-9)


@settings(deadline=None, derandomize=True)
@given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_panoramic_inverts_cosine_cells_in_every_direction(vector):
    sun = np.array([vector]) / np.linalg.norm(vector)
    normals = np.vstack([FACES, *(np.array(FACES[:2]) + np.array(f) for f in FACES[2:])])
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    normals = np.vstack([normals, corners / np.sqrt(3)])
    model = WeightedCells(as_design(normals)).fit(cosines(spread(200), normals), spread(200))
    assert separation_deg(model.predict(cosines(sun, normals)), sun).max() < 1e-9


def test_grazing_cells_are_left_out():
    normals = np.vstack([survey_pyramid(6, 40.0), [[np.sin(1.4), 0.0, np.cos(1.4)]]])
    sun = direction(0.0, 0.0)
    model = WeightedCells(as_design(normals)).fit(cosines(spread(200), normals), spread(200))
    signals = cosines(sun, normals)
    assert signals[0, 6] < np.cos(np.radians(75))
    signals[0, 6] = 0.2  # far too much, still below cos(75 deg) = 0.26
    assert separation_deg(model.predict(signals), sun).max() < 1e-9
    signals[0, 6] = 0.3
    assert separation_deg(model.predict(signals), sun).max() > 1


def test_panoramic_gives_nothing_where_too_few_cells_are_lit():
    flat = np.array([[1, 0, 0], [0, 0, 1], [np.sqrt(0.5), 0, np.sqrt(0.5)], [0, 1, 0]])
    model = WeightedCells(as_design(flat)).fit(cosines(spread(200), flat), spread(200))
    rows = np.array(
        [[0.5, 0.5, 0.7, 0.5], [0.5, 0.7, 0.8, 0], [0.5, 0, 0, 0.5], [0] * 4, [-1, -1, -1, -1]]
    )
    assert np.isnan(model.predict(rows)).all(axis=1).tolist() == [False, True, True, True, True]


@settings(deadline=None, derandomize=True, max_examples=50)
@given(st.integers(0, 10_000))
def test_lit_cells_in_a_plane_give_nothing_however_they_round(seed):
    turned, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    ring = np.radians([0, 25, 50, 70])
    plane = np.column_stack([np.cos(ring), np.sin(ring), np.zeros(4)])
    normals = np.vstack([plane, [[0, 0, 1]]]) @ turned
    sun = np.array([np.cos(0.6), np.sin(0.6), 0.0]) @ turned
    model = WeightedCells(as_design(normals)).fit(cosines(spread(200), normals), spread(200))
    assert np.isnan(model.predict(cosines(sun[None], normals))).all()
    two = np.array([[0.0, 0.8, 0.0, 0.0, 0.5]])
    assert np.isnan(model.predict(two)).all()


@pytest.mark.parametrize(
    ("normals", "half_fov_deg", "fewest"),
    [
        (FACES, None, 1),  # the Sun on an axis
        (survey_pyramid(4, 30.0), 55.0, 2),  # between two faces, far out
        (survey_pyramid(6, 30.0), None, 0),
        (survey_pyramid(4, 30.0), 30.0, None),
        (survey_pyramid(6, 30.0), 55.0, None),
    ],
)
def test_panoramic_refuses_bodies_that_leave_directions_unsolved(normals, half_fov_deg, fewest):
    design = SensorGeometry(face_normals=as_design(normals), half_fov_deg=half_fov_deg)
    if fewest is None:
        model = WeightedCells.for_sensor(design, FeatureKind.SIGNALS)
        assert model.face_normals == design.face_normals
    else:
        with pytest.raises(ValueError, match=f"faces leave {fewest}"):
            WeightedCells.for_sensor(design, FeatureKind.SIGNALS)


def anywhere(normals):
    return WeightedCells(as_design(normals), extrapolation=math.inf)


def test_a_cell_never_lit_in_calibration_takes_the_others_reference():
    normals = np.array(FACES)
    sun = spread(200)
    sun = sun[sun[:, 2] > 0.1]
    reference = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 100.0])
    model = WeightedCells(FACES).fit(reference * cosines(sun, normals), sun)
    assert model.reference_ == pytest.approx([1, 2, 3, 4, 5, 3])
    up = direction(0.0, 0.0)
    with pytest.raises(ValueError, match="light a cell"):
        anywhere(survey_pyramid(3, 80.0)).fit(np.ones((1, 3)), up)
    with pytest.raises(ValueError, match="positive signals"):
        anywhere(survey_pyramid(3, 30.0)).fit(-np.ones((1, 3)), up)


# Solar panel


@settings(deadline=None, derandomize=True)
@given(
    st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3),
    st.permutations(FACES),
    st.integers(0, 1000),
    st.floats(1e-3, 1e6),
)
def test_solar_panels_invert_a_cosine_body_turned_any_way(vector, faces, seed, light):
    turned, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    normals = np.array(faces, dtype=float) @ turned
    sun = np.array([vector]) / np.linalg.norm(vector)
    signals = light * cosines(sun, normals)
    model = SolarPanels(as_design(normals)).fit(signals, sun)
    assert separation_deg(model.predict(signals), sun).max() < 1e-9
    # light on all panels alike cancels
    assert separation_deg(model.predict(signals + 0.3 * light), sun).max() < 1e-9


def test_solar_panels_follow_the_corrected_equation():
    """eq:msfsc: sum n_i I_i over lit panels, a unit vector after dividing by root sum I_i^2."""
    signals = np.array([0.3, 0.0, -0.1, 0.8, 0.5, -0.2])
    lit = signals > 0
    expected = (np.array(FACES)[lit] * signals[lit, None]).sum(axis=0)
    expected = expected / np.sqrt((signals[lit] ** 2).sum())
    assert np.linalg.norm(expected) == pytest.approx(1.0)
    model = SolarPanels(FACES).fit(signals[None], [[0.0, 0.0, 1.0]])
    np.testing.assert_allclose(model.predict(signals[None]), [expected], atol=1e-15)
    dark = np.array([[0.0] * 6, [-0.1] * 6, [0.2, 0.2, 0.0, 0.0, 0.0, 0.0]])
    assert np.isnan(model.predict(dark)).all()
