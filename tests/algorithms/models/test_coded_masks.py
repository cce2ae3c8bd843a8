"""Coded masks against sensors written down here, and against every place tried one by one."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.special import logsumexp
from scipy.stats import multivariate_t

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.calibration.coded.places import offsets_of, turn_of
from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.models.multiplex.coded_correlation import CodedCorrelation
from algorithms.models.multiplex.coded_spacing import CodedSpacing

MODELS = [CodedSpacing, CodedCorrelation]
SIZE, FOCAL_MM, PITCH_MM = 120.0, 2.0, 0.01
MIDDLE = (SIZE - 1.0) / 2.0


def groups(count=9, pitch=0.55, first=0.18, step=0.012):
    """Wei2014's groups of three: a corner, and two holes whose distances are row and column."""
    holes = []
    for j in range(count):
        for i in range(count):
            x, y = pitch * (i - (count - 1) / 2), pitch * (j - (count - 1) / 2)
            holes += [(x, y), (x + first + step * i, y), (x, y + first + step * j)]
    return tuple((round(x, 4), round(y, 4), 0.05) for x, y in holes)


def design(apertures):
    return SensorGeometry(
        focal_length_mm=FOCAL_MM,
        pixel_pitch_mm=PITCH_MM,
        centre_px=(MIDDLE, MIDDLE),
        apertures=apertures,
        half_fov_deg=45.0,
    )


DESIGN = design(groups())


def model_of(cls, geometry=DESIGN, **changes):
    model = replace(cls.for_sensor(geometry, FeatureKind.SPOTS), **changes)
    # as one reads that is fitted and has found no error: for its places kernels are compiled
    model.turn_, model.offsets_ = 0.0, np.zeros((len(geometry.apertures), 2))
    return model


def lists(places, displacements, spots):
    """Spots well on the detector of places (A, 2) px that are displaced (N, 2), all as bright."""
    rows = np.zeros((len(displacements), spots, 3))
    for row, displacement in zip(rows, displacements, strict=True):
        seen = places + displacement
        seen = seen[(np.abs(seen - MIDDLE) < MIDDLE - 5.0).all(axis=1)]
        row[: len(seen), :2] = seen
        row[: len(seen), 2] = 100.0
    return rows


def places_px(geometry=DESIGN):
    return np.array(geometry.apertures)[:, :2] / PITCH_MM


def field(count, half_deg=42.0, seed=3):
    return sun_from_angles(np.random.default_rng(seed).uniform(-half_deg, half_deg, (count, 2)))


def cast(sun, focal_mm=FOCAL_MM, centre=(MIDDLE, MIDDLE)):
    return np.array(centre) + sun[:, :2] / sun[:, 2:] * (focal_mm / PITCH_MM)


@pytest.mark.parametrize("cls", MODELS)
def test_a_built_sensor_without_noise_is_inverted(cls):
    """Mask turned, holes off their places, head turned and tilted, another height and centre."""
    model, rng = model_of(cls), np.random.default_rng(8)
    c, s = math.cos(math.radians(0.4)), math.sin(math.radians(0.4))
    built = places_px() @ np.array([[c, s], [-s, c]]) + rng.normal(0.0, 0.1, (243, 2))
    sun = field(500)
    tilt, turn = np.radians(0.7), np.radians(1.1)
    tilted = np.array(
        [[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]]
    )
    turned = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    features = lists(built, cast(sun @ tilted @ turned, 2.01, (61.0, 58.0)), model.spots)
    features = features.reshape(len(sun), -1)
    model.fit(features[:400], sun[:400])
    error = separation_deg(model.predict(features[400:]), sun[400:])
    # offsets of single holes that are predicted, not known, leave a part of theirs
    assert np.isfinite(error).mean() > 0.97
    assert np.sqrt(np.nanmean(error**2)) < 0.004 < 0.1 / 200.0 * 57.3
    assert model.turn_ == pytest.approx(0.4, abs=0.05)  # a turn is offsets too

    exact = model_of(cls)
    features = lists(places_px(), cast(sun @ tilted @ turned, 2.01, (61.0, 58.0)), model.spots)
    features = features.reshape(len(sun), -1)
    error = separation_deg(exact.fit(features[:400], sun[:400]).predict(features[400:]), sun[400:])
    assert np.nanmax(error) < 1e-6


def test_cover_glass_is_inverted_by_snells_law():
    plates = ((0.5, 1.5), (0.3, 1.8))
    model = model_of(CodedSpacing, replace(DESIGN, cover_glass=plates))
    sun = field(300)
    sine = np.hypot(sun[:, 0], sun[:, 1])
    tangent, way = sine / sun[:, 2], FOCAL_MM - 0.8
    reach = way * tangent + sum(t * np.tan(np.arcsin(sine / n)) for t, n in plates)
    displaced = MIDDLE + sun[:, :2] / sine[:, None] * reach[:, None] / PITCH_MM
    features = lists(places_px(), displaced, model.spots).reshape(len(sun), -1)
    error = separation_deg(model.fit(features[:250], sun[:250]).predict(features[250:]), sun[250:])
    assert np.nanmax(error) < 1e-6


def residuals_density(squares, dimensions, tolerance):
    """Logarithm: a fifth of the tolerance, or once in 10 000 lists a half, as t has it."""
    if dimensions == 0:
        return 0.0
    at = np.zeros(dimensions)
    at[0] = math.sqrt(squares)
    expected = [
        multivariate_t.logpdf(at, shape=(tolerance / deviations) ** 2 * np.eye(dimensions), df=df)
        for deviations, df in ((5.0, 30.0), (2.0, 4.0))
    ]
    return float(logsumexp(expected, b=[1.0 - 1e-4, 1e-4]))


def evidence_everywhere(spots, model):
    """Places at which some spot falls on an aperture, all of them, and the evidence for each."""
    drawn = model._drawn
    return _evidence(spots.tobytes(), tuple(map(float, drawn.view)), drawn.widest, drawn.tolerance)


@cache  # both models are asked of the same lists
def _evidence(listed, view, widest, tolerance):
    places, view, spots = places_px(), np.array(view), np.frombuffer(listed).reshape(-1, 3)
    at, found = [], []
    for named in (spots[:, None, :2] - places).reshape(-1, 2):
        here = named
        for _ in range(2):
            off = np.abs(spots[:, None, :2] - here - places)
            away = np.maximum(off[:, :, 0], off[:, :, 1])
            partner = np.where(away.min(axis=1) <= widest, away.argmin(axis=1), -1)
            kept = np.flatnonzero(partner >= 0)
            if 2 * len(kept) < len(spots):
                break
            moved = spots[kept, :2] - places[partner[kept]]
            here = moved.mean(axis=0)
        if 2 * len(kept) < len(spots):  # far below any that explains the most of them
            continue
        squares = ((moved - here) ** 2).sum()
        margin = view[5] + view[6] * (1.0 + ((here - view[2:4]) ** 2).sum() / view[4] ** 2)
        inside = np.abs(places + here - MIDDLE).max(axis=1) <= MIDDLE - margin
        inside[partner[kept]] = False
        left = len(spots) - len(kept)
        expected = residuals_density(squares, 2 * len(kept) - 2, tolerance)
        expected -= left * math.log(100.0 * SIZE**2)
        expected += math.log(0.9 * 0.01 ** inside.sum() + 0.1 * 0.2 ** inside.sum())
        at.append(here)
        found.append(expected)
    return np.array(at), np.array(found)


@pytest.mark.parametrize(
    "cls", [CodedCorrelation, pytest.param(CodedSpacing, marks=pytest.mark.slow)]
)
def test_what_is_read_is_what_trying_every_place_finds(cls):
    """Holes missing, spots too many and noisy: read is what is far likelier than all others."""
    model, rng = model_of(cls), np.random.default_rng(21)
    count = 6
    displaced = cast(field(count, seed=5))
    rows = lists(places_px(), displaced, model.spots)
    for k, row in enumerate(rows):
        kept = row[row[:, 2] > 0]
        kept = kept[rng.random(len(kept)) > 0.15]
        kept[:, :2] += (0.0, 0.1, 0.6)[k % 3] * rng.standard_normal((len(kept), 2))
        stray = [[*rng.uniform(8, SIZE - 9, 2), 100.0]] if rng.random() < 0.3 else np.empty((0, 3))
        row[:] = 0.0
        row[: len(kept) + len(stray)] = np.vstack([kept, stray])
    reading = model.read(rows.reshape(count, -1))
    answered = 0
    for row, found in zip(rows, reading.displacement, strict=True):
        spots = row[row[:, 2] > 0]
        at, evidence = evidence_everywhere(spots, model)
        best = at[evidence.argmax()]
        others = evidence[np.abs(at - best).max(axis=1) > 2.0 * model._drawn.widest]
        clear = evidence.max() - others.max() >= math.log(model.odds)
        if np.isfinite(found[0]):
            answered += 1
            assert clear
            assert np.hypot(*(found - best)) < 0.7
        else:
            assert not clear or len(spots) < 2 * model.agreeing
    assert 2 <= answered < count


@pytest.mark.parametrize("cls", MODELS)
def test_spots_that_fill_the_tolerance_tell_no_place(cls):
    """Noise as wide as steps of the code: hardly any list is answered, and none wrongly."""
    model, rng = model_of(cls), np.random.default_rng(41)
    displaced = cast(field(200, seed=9))
    rows = lists(places_px(), displaced, model.spots)
    rows[:, :, :2] += np.where(rows[:, :, 2:] > 0, 0.7, 0.0) * rng.standard_normal(
        rows[:, :, :2].shape
    )
    found = model.read(rows.reshape(200, -1))
    off = np.hypot(*(found.displacement - displaced).T)
    assert not (off > 3.0).any()
    assert found.ambiguous.mean() > 0.3
    # the same spots where they belong
    expected = model.read(lists(places_px(), displaced, model.spots).reshape(200, -1)).displacement
    assert np.isfinite(expected[:, 0]).mean() > 0.97


def test_pieces_of_one_spot_are_one_spot():
    model = model_of(CodedSpacing)
    rows = lists(places_px(), cast(field(20, seed=4)), model.spots)
    twice = rows.copy()
    for row in twice:
        number = int((row[:, 2] > 0).sum())
        row[number : number + 2] = row[:2] + np.array((0.2, -0.2, 0.0))
    whole, pieces = (model.read(x.reshape(20, -1)) for x in (rows, twice))
    np.testing.assert_array_equal(
        (pieces.apertures >= 0).sum(axis=1), (whole.apertures >= 0).sum(axis=1)
    )


@pytest.mark.parametrize("cls", MODELS)
def test_no_place_is_told_wrongly_with_a_fifth_of_the_holes_missing(cls):
    model, rng = model_of(cls), np.random.default_rng(31)
    displaced = cast(field(400, seed=7))
    answers = wrong = 0
    for start in range(0, 400, 40):  # ten units
        open_ = rng.random(243) > 0.2
        rows = lists(places_px()[open_], displaced[start : start + 40], model.spots)
        found = model.read(rows.reshape(40, -1)).displacement
        off = np.hypot(*(found - displaced[start : start + 40]).T)
        answers += np.isfinite(off).sum()
        wrong += (off > 1.0).sum()
    assert wrong == 0
    assert answers > 60


@pytest.mark.parametrize("cls", MODELS)
def test_a_mask_without_a_code_is_not_read(cls):
    grid = np.stack(np.meshgrid(np.arange(-8, 9), np.arange(-8, 9)), -1).reshape(-1, 2) * 0.3
    geometry = design(tuple((x, y, 0.05) for x, y in grid.tolist()))
    model = model_of(cls, geometry)
    sun = field(30, 20.0)
    features = lists(places_px(geometry), cast(sun), model.spots).reshape(30, -1)
    reading = model.read(features)
    assert np.isnan(reading.displacement).all()
    assert reading.ambiguous.all()
    with pytest.raises(UnusableDataError, match="code"):
        model.fit(features[:20], sun[:20])


@pytest.mark.parametrize("cls", MODELS)
def test_sizes_are_a_code(cls):
    """Columns that widths alone tell apart, any two side by side; light goes as w to the 2.5."""
    near, number = places_px(), np.arange(243)
    column, across = number // 3 % 9, number % 3 == 1
    near[across, 0] -= 1.2 * column[across]
    step = np.array([0, 0, 1, 1, 2, 2, 0, 2, 1])[column] * across
    widths = 0.04 * 1.4**step
    holes = np.column_stack([near * PITCH_MM, widths]).round(6)
    geometry = design(tuple(map(tuple, holes.tolist())))
    displaced = cast(field(60, 38.0))
    read = []
    for tolerance in (0.17, None):
        model = model_of(cls, geometry, size_tolerance=tolerance)
        rows = lists(near, displaced, model.spots)
        for row, at in zip(rows, displaced, strict=True):
            seen = row[:, 2] > 0
            nearest = np.abs(row[seen][:, None, :2] - at - near).max(axis=2).argmin(axis=1)
            row[seen, 2] = 1e4 * widths[nearest] ** 2.5
        found = model.read(rows.reshape(60, -1)).displacement
        off = np.hypot(*(found - displaced).T)
        assert not (off > 0.5).any()
        read.append(np.isfinite(off).sum())
    assert read[0] > 2 * read[1] + 10


def test_a_spot_that_disagrees_is_left_out():
    model = model_of(CodedSpacing)
    sun = field(300)
    features = lists(places_px(), cast(sun), model.spots)
    model.fit(features.reshape(300, -1), sun)
    moved = features.copy()
    moved[:, 0, 0] += 0.4  # within the tolerance of its place
    off = separation_deg(model.predict(moved.reshape(300, -1)), sun)
    assert np.nanmax(off) < 1e-6


def test_offsets_are_those_of_the_mixed_models_normal_equations():
    """Against a dense solution for one given ratio: the best linear unbiased prediction."""
    rng = np.random.default_rng(2)
    places = rng.uniform(-50, 50, (12, 2))
    true = rng.normal(0.0, 0.2, (12, 2))
    apertures = np.array([rng.permutation(12)[:5] for _ in range(400)])
    spots = (places + true)[apertures] + rng.uniform(-30, 30, (400, 1, 2))
    spots += rng.normal(0.0, 0.02, spots.shape)
    found = offsets_of(spots, apertures, places)
    # what all holes are off together is the frames' displacement
    np.testing.assert_allclose(found, true - true.mean(axis=0), atol=0.012)
    assert turn_of(spots, apertures, places @ np.array([[1, 0.01], [-0.01, 1]])) == pytest.approx(
        -0.57, abs=0.4
    )


def test_a_mask_that_is_seen_whole_needs_no_code():
    small = design(((-0.1, 0.0, 0.05), (0.1, 0.0, 0.05), (0.0, 0.1, 0.05), (0.0, -0.1, 0.05)))
    with pytest.raises(UnsuitableDesignError, match="larger than their detector"):
        CodedSpacing.for_sensor(small, FeatureKind.SPOTS)


def test_a_list_with_a_gap_is_refused():
    model = model_of(CodedSpacing)
    rows = lists(places_px(), cast(field(1)), model.spots)
    rows[0, 0, 2] = 0.0
    with pytest.raises(ValueError, match="last"):
        model.read(rows.reshape(1, -1))
