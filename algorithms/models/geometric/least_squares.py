"""The LSQ geometric model: focal length, boresight and zero point fitted by least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.angles import rotations_from_sun
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.parametric import RADIAN_DEG, FreeParameter, ParametricModel
from algorithms.calibration.projection import ProjectionModel
from algorithms.contract import AboutModel, Floats
from algorithms.documented import documented
from algorithms.models.nominal_projection import (
    POSITIONS,
)


@documented
@dataclass
class LeastSquaresGeometry(ProjectionModel, ParametricModel):
    """Pinhole projection with calibrated focal length, two boresight offsets and zero point.

    The five parameters that cause most of a built sensor's error are found by nonlinear least
    squares on the measured rotation angles, starting from the drawing.

    Parameters
    ----------
    focal_length_mm : float
        Nominal distance F from aperture to detector, positive.
    centre : tuple of two float
        Nominal feature (x, y) of the spot when both angles are zero; where the fit of the zero
        point starts.


    Attributes
    ----------
    vector_ : ndarray, shape (5,)
        Delta F in mm, alpha_0 and beta_0 in degrees, x_zp and y_zp in the features' unit.

    Notes
    -----
    Implements: eq:lsq (model:lsq, Rufino2004a). With ``F' = F + Delta F`` and the spot's
    displacement ``(X, Y)`` in mm from the zero point, ``beta_m = -beta_0 + arctan((X + F'
    tan(beta_0)) / F')`` and ``alpha_m = -alpha_0 + arctan[(1 / F') cos(beta_m + beta_0) (Y + F'
    tan(alpha_0) / cos(beta_0))]``. The survey prints the last bracket without its plus; corrected
    because the zero point must give zero angles. The survey prints ``x_zp - x``; here ``X = (x -
    x_zp) unit_mm``, because the detector's axes are flipped so that a spot falls at ``X = h
    tan(beta)``.

    The angles are rotations, ``s = (sin(beta_m) cos(alpha_m), sin(alpha_m), cos(beta_m)
    cos(alpha_m))``, as the two axes of a turntable give them. The offsets are added to those
    angles: exact for a turntable whose zero is off, and for a head turned about its y axis; a
    head turned about x is matched only near beta = 0.

    Failure: a NaN row for a NaN feature row and outside the hull. fit raises UnusableDataError
    below 3 samples, where the samples do not determine the five parameters (all in one place, or
    one axis swept alone), where it does not converge, or where its residuals are as large as the
    field: with swapped or mirrored axes, which it does not know (`pinhole` does).

    Cost: 5 transcendental functions and 20 operations per sample; the fit, some ten times eleven
    passes over the samples.

    Examples
    --------
    >>> from algorithms.angles import angles_from_sun
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-20, 21, 20))
    >>> spots = 212.0 * sun[:, :2] / sun[:, 2:] + (100.7, 79.5)  # 0.12 mm too long
    >>> model = LeastSquaresGeometry(focal_length_mm=2.0, unit_mm=0.01, centre=(100.0, 80.0))
    >>> round(model.fit(spots, sun).quality_.parameter("focal_length_error").value, 4)
    0.12
    >>> angles_from_sun(model.predict(spots[[0, 8]])).round(3)
    array([[-20., -20.],
           [ 20.,  20.]])
    """

    about: ClassVar = AboutModel(
        name="lsq",
        taxonomy="LSQ",
        studies=("Rufino2004a",),
        labels=("model:lsq", "eq:lsq"),
        origin="survey",
        needs=("focal_length_mm",),
        accepts=POSITIONS,
    )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing: where a fit starts."""
        focal, reach = self.focal_length_mm, self.focal_length_mm / self.unit_mm
        x, y = self.centre
        return (
            FreeParameter("focal_length_error", "mm", focal),
            FreeParameter("alpha_0", "deg", RADIAN_DEG),
            FreeParameter("beta_0", "deg", RADIAN_DEG),
            FreeParameter("x_zp", "", reach, x),
            FreeParameter("y_zp", "", reach, y),
        )

    def residuals(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2) errors of the rotation angles, which the study makes small, radians."""
        del axes, context
        return self._angles(vector, features) - np.radians(rotations_from_sun(sun))

    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) directions of features (N, 2).

        Those of the rotation angles, without a trigonometric function of a sample: sines and
        cosines of an arc tangent are roots, and the offsets turn them.
        """
        from algorithms.models.geometric.projection_kernel import project_and_turn  # noqa: PLC0415 - Numba

        del context
        stretch, _, _, left, low = (float(value) for value in vector)
        alpha_0, beta_0 = (float(angle) for angle in np.radians(vector[1:3]))
        tan_beta, tan_alpha = float(np.tan(beta_0)), float(np.tan(alpha_0) / np.cos(beta_0))
        scale = float(self.unit_mm) / (float(self.focal_length_mm) + stretch)
        turns = tuple(float(wave(turn)) for turn in (beta_0, alpha_0) for wave in (np.sin, np.cos))
        sun = np.empty((len(features), 3))
        project_and_turn(
            features[:, 0],
            features[:, 1],
            ((left, low), (tan_beta, tan_alpha), scale),
            (turns[0], turns[1], turns[2], turns[3]),
            sun,
        )
        return sun

    def _angles(self, vector: Floats, features: Floats) -> Floats:
        """Rotation angles (N, 2) in radians."""
        scale = self.unit_mm / self.focal_length_mm
        parameters = np.array(
            [vector[0] / self.focal_length_mm, *np.radians(vector[1:3]), 0.0, 0.0]
        )
        return rotation_angles(parameters, (features - vector[3:]) * scale)


def rotation_angles(parameters: Floats, spot: Floats) -> Floats:
    """Return ``(alpha_m, beta_m)`` (N, 2) in radians, eq:lsq in units of the nominal focal length.

    Parameters
    ----------
    parameters : ndarray, shape (5,)
        ``(Delta F / F, alpha_0, beta_0, x_zp, y_zp)``, angles in radians.
    spot : ndarray, shape (N, 2)
        Spot displacements from the nominal centre over the nominal focal length.
    """
    stretch, alpha_0, beta_0, x_zp, y_zp = parameters
    focal = 1.0 + stretch
    across = (spot[:, 0] - x_zp) / focal + np.tan(beta_0)
    along = (spot[:, 1] - y_zp) / focal + np.tan(alpha_0) / np.cos(beta_0)
    beta = np.arctan(across) - beta_0
    alpha = np.arctan(along / np.hypot(1.0, across)) - alpha_0
    return np.column_stack([alpha, beta])
