"""Calibrations that models refuse, and designs that they are not made for."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.contract import FeatureKind, Floats, SensorGeometry
from algorithms.contract import UnusableDataError as Unusable
from algorithms.models.geometric.panoramic_temperature import WarmCells
from algorithms.models.multiplex.coded_spacing import CodedSpacing
from algorithms.models.neural_network.deep_signals import DeepSignals
from algorithms.models.non_physical.panel_curves import AveragedPanelCurves
from algorithms.models.non_physical.sigmoid import SigmoidBalance
from algorithms.models.non_physical.signal_polynomial import SignalPolynomial
from algorithms.models.non_physical.trigonometric import TrigonometricPanels
from algorithms.models.physics_informed.faces_fit import FacesFit

CUBE = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
RAYS = np.array(CUBE, dtype=float)
PYRAMID = ((0.6, 0.0, 0.8), (-0.6, 0.0, 0.8), (0.0, 0.6, 0.8), (0.0, -0.6, 0.8))


def sphere(count: int = 300, seed: int = 3) -> Floats:
    vectors = np.random.default_rng(seed).normal(size=(count, 3))
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def field(count: int = 80, half_deg: float = 30.0, seed: int = 5) -> Floats:
    return sun_from_angles(np.random.default_rng(seed).uniform(-half_deg, half_deg, (count, 2)))


# Signals


@pytest.mark.parametrize(
    "model", [SignalPolynomial(signals=4), DeepSignals(signals=4, hidden=2, restarts=1)]
)
def test_signals_that_never_change_tell_no_direction(model: Any) -> None:
    sun = field(200)
    with pytest.raises(Unusable, match=f"{model.about.name} needs samples in which a signal chang"):
        model.fit(np.full((200, 4), 0.7), sun)


def test_cells_turned_to_the_sun_must_have_positive_currents() -> None:
    sun = field()
    warm = {"temperature_K": 290.0 + np.arange(80.0)}
    signals = np.maximum(sun @ np.array(PYRAMID).T, 0.0)
    assert (WarmCells(PYRAMID).fit(signals, sun, warm).reference_ > 0).all()
    with pytest.raises(Unusable, match=r"positive signals.*reference current of -1"):
        WarmCells(PYRAMID).fit(signals * (1.0, 1.0, -1.0, 1.0), sun, warm)


def test_one_pose_does_not_settle_how_faces_are_mounted() -> None:
    sun = np.tile([0.0, 0.0, 1.0], (20, 1))
    signals = sun @ np.array(PYRAMID).T
    fit = FacesFit(np.array(PYRAMID), signals, sun, "faces")
    with pytest.raises(Unusable, match="do not settle gains, normals and response of 4 faces"):
        fit.solve(each=False)


# Panels


def test_a_panel_whose_samples_are_all_of_one_pose_is_taken_from_its_opposite() -> None:
    sun = sphere()
    sun = np.vstack([sun[sun[:, 0] < -0.05], np.tile([1.0, 0.0, 0.0], (10, 1))])
    signals = np.maximum(sun @ RAYS.T, 0.0)
    model = TrigonometricPanels(CUBE).fit(signals, sun)
    np.testing.assert_allclose(model.amplitudes_[0], -model.amplitudes_[1], atol=1e-15)
    np.testing.assert_allclose(model.amplitudes_, RAYS, atol=1e-9)
    assert np.isnan(model.deviations_[0]).all()
    assert separation_deg(model.predict(signals), sun).max() < 1e-6


def test_panels_that_look_along_one_plane_as_fitted_are_refused() -> None:
    sun = sphere()
    signals = sun @ RAYS.T
    signals[:, 0] = sun @ (0.0, 0.6, 0.8)  # as if the +x panel looked between +y and +z
    with pytest.raises(Unusable, match="cosines of three panels lie in one plane"):
        TrigonometricPanels(CUBE).fit(signals, sun)


def test_averaged_curves_that_rise_only_past_their_lowest_point_are_inverted() -> None:
    """``m = a + b x + c (2 x^2 - 1)`` falls up to -b / 4c: below any cosine of the calibration."""
    sun = sphere(3000)
    sun = sun[np.abs(sun).min(axis=1) > 0.3]
    cosines = sun @ RAYS.T
    signals = np.where(cosines > 0, 1.1 - 0.5 * cosines + (2 * cosines**2 - 1), 0.0)
    model = AveragedPanelCurves(CUBE).fit(signals, sun)
    np.testing.assert_allclose(model.curves_, [[1.1, -0.5, 1.0]] * 3, atol=1e-9)
    assert separation_deg(model.predict(signals), sun).max() < 1e-6


# Balances


def test_balances_need_suns_that_spread_along_both_angles() -> None:
    angles = np.column_stack([np.zeros(30), np.linspace(-20.0, 20.0, 30)])
    balances = np.random.default_rng(1).normal(size=(30, 2))
    with pytest.raises(Unusable, match="sigmoid needs Suns that spread along both angles"):
        SigmoidBalance().fit(balances, sun_from_angles(angles))


@pytest.fixture(scope="module")
def straight() -> tuple[SigmoidBalance, Floats, Floats]:
    """Model fitted to balances that go straight with the angles, balances (n, 2), Suns (n, 3)."""
    angles = np.stack(np.meshgrid(*[np.arange(-20.0, 21.0, 5.0)] * 2), axis=-1).reshape(-1, 2)
    balances, sun = 0.5 * np.radians(angles[:, ::-1]) + 0.01, sun_from_angles(angles)
    return SigmoidBalance().fit(balances, sun), balances, sun


def test_a_curve_without_bend_is_a_straight_line(
    straight: tuple[SigmoidBalance, Floats, Floats],
) -> None:
    model, balances, sun = straight
    line = np.array([0.5, 0.0, 0.0, 0.0, 0.0, 0.01] * 2)
    assert separation_deg(model.directions(line, balances, {}), sun).max() < 1e-6


# Coded masks


def coded(**changes: Any) -> SensorGeometry:
    """Groups of three holes, 0.55 mm apart: a corner, and two whose distances are row and column.

    `test_coded_masks` has them as Wei2014 does; these are fewer.
    """
    holes = []
    for row in range(6):
        for column in range(6):
            x, y = 0.55 * (column - 2.5), 0.55 * (row - 2.5)
            holes += [(x, y), (x + 0.18 + 0.012 * column, y), (x, y + 0.18 + 0.012 * row)]
    drawn: dict[str, Any] = {
        "focal_length_mm": 2.0,
        "pixel_pitch_mm": 0.01,
        "centre_px": (59.5, 59.5),
        "apertures": tuple((round(x, 4), round(y, 4), 0.05) for x, y in holes),
        "half_fov_deg": 30.0,
    }
    return SensorGeometry(**{**drawn, **changes})


@pytest.mark.slow
@pytest.mark.parametrize("turn_deg", [1.6, -1.6])
def test_a_mask_turned_too_far_to_be_read_as_drawn_is_read_turned(turn_deg: float) -> None:
    design = coded()
    model = CodedSpacing.for_sensor(design, FeatureKind.SPOTS)
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    places = np.array(design.apertures)[:, :2] / 0.01 @ np.array([[c, s], [-s, c]])
    sun = field(60, 25.0)
    lists = np.zeros((60, model.spots, 3))
    for row, at in zip(lists, 59.5 + 200.0 * sun[:, :2] / sun[:, 2:], strict=True):
        seen = (places + at)[(np.abs(places + at - 59.5) < 54.5).all(axis=1)]
        row[: len(seen), :2], row[: len(seen), 2] = seen, 100.0
    features = lists.reshape(60, -1)
    as_drawn = np.isfinite(model.read(features).displacement[:, 0])
    assert as_drawn.mean() < 0.5
    assert model.fit(features, sun).turn_ == pytest.approx(turn_deg, abs=1e-6)
    error = separation_deg(model.predict(features), sun)
    assert np.isfinite(error).mean() > 0.9
    assert np.nanmax(error) < 1e-6
