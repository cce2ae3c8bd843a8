"""The LSQ geometric model: focal length, boresight and zero point fitted by least squares."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.angles import rotations_from_sun, sun_from_rotations
from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Floats,
    Model,
    SensorGeometry,
    UnusableDataError,
)
from algorithms.inputs import (
    as_features,
    as_frontal_calibration,
    require_fitted,
    require_samples,
)
from algorithms.models.conditioning import WORST_CONDITION
from algorithms.models.nominal_projection import (
    POSITIONS,
    nominal_projection,
    require_projection,
)

TOLERANCE = 1e-15
"""Relative change of cost, step and gradient at which the fit stops: machine precision."""

MAX_EVALUATIONS = 1000


@dataclass
class LeastSquaresGeometry(Model):
    """Pinhole projection with focal length, two boresight offsets and zero point calibrated.

    The five numbers that carry most of a built sensor's error are found by nonlinear least
    squares on the measured rotation angles, starting from the drawing.

    Parameters
    ----------
    focal_length_mm : float
        Nominal distance F from aperture to detector, positive.
    unit_mm : float
        Displacement of the spot for one unit of feature, positive: the pixel pitch for spots,
        half the aperture's width for balances.
    centre : tuple of two float
        Nominal feature (x, y) of the spot when both angles are zero; where the fit of the zero
        point starts.

    Attributes
    ----------
    focal_length_error_mm_ : float
        Delta F.
    boresight_deg_ : tuple of two float
        ``(alpha_0, beta_0)``.
    zero_point_ : tuple of two float
        ``(x_zp, y_zp)``, in the features' unit.
    residual_rms_deg_ : float
        Root mean square of the angle residuals over both axes.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: eq:lsq (model:lsq, Rufino2004a). With ``F' = F + Delta F`` and the spot's
    displacement ``(X, Y)`` in mm from the zero point,
    ``beta_m = -beta_0 + arctan((X + F' tan(beta_0)) / F')`` and
    ``alpha_m = -alpha_0 + arctan[(1 / F') cos(beta_m + beta_0) (Y + F' tan(alpha_0) /
    cos(beta_0))]``. Survey prints the last bracket without its plus; corrected because the zero
    point must give zero angles. Survey prints ``x_zp - x``; here ``X = (x - x_zp) unit_mm``,
    because the detector's axes are flipped so that a spot falls at ``X = h tan(beta)``.

    The angles are rotations, ``s = (sin(beta_m) cos(alpha_m), sin(alpha_m), cos(beta_m)
    cos(alpha_m))``, as the two axes of a turntable give them. The offsets are added to those
    angles: exact for a turntable whose zero is off, and for a head turned about its y axis; a
    head turned about x is matched only near beta = 0.

    Shapes: features ``(x, y)`` (N, 2), in px or dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row. fit raises UnusableDataError below 3 samples, where
    the samples do not settle the five parameters (all in one place, or alpha swept alone), or where
    it does not converge.

    Cost: 5 transcendental functions and 20 operations a sample; the fit, some ten passes of
    about 80 operations a sample and a QR factorisation (2 N, 5) each.

    References
    ----------
    Rufino2004a; survey model:lsq, eq:lsq.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.angles import angles_from_sun, sun_from_angles
    >>> steps = [-20, 0, 20]
    >>> sun = sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))
    >>> spots = 212.0 * sun[:, :2] / sun[:, 2:] + (100.7, 79.5)  # 0.12 mm too long
    >>> model = LeastSquaresGeometry(focal_length_mm=2.0, unit_mm=0.01, centre=(100.0, 80.0))
    >>> round(float(model.fit(spots, sun).focal_length_error_mm_), 4)
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

    focal_length_mm: float
    unit_mm: float
    centre: tuple[float, float] = (0.0, 0.0)

    focal_length_error_mm_: float = field(init=False, repr=False, compare=False)
    boresight_deg_: tuple[float, float] = field(init=False, repr=False, compare=False)
    zero_point_: tuple[float, float] = field(init=False, repr=False, compare=False)
    residual_rms_deg_: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        require_projection(self.about.name, self.focal_length_mm, self.unit_mm, self.centre)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing."""
        return cls(**nominal_projection(geometry, kind, cls.about))

    def fit(self, features: ArrayLike, sun: ArrayLike) -> Self:
        """Fit Delta F, (alpha_0, beta_0) and (x_zp, y_zp) to the Sun's rotation angles."""
        from scipy.optimize import least_squares  # noqa: PLC0415 - SciPy, at the first fit only

        found, vectors = as_frontal_calibration(features, sun, self.about.name)
        require_samples(len(found), 3, self.about.name, "five parameters, two angles a sample")
        measured = np.radians(rotations_from_sun(vectors))
        # Displacements in units of F, so that all five parameters are of order one.
        scale = self.unit_mm / self.focal_length_mm
        spot = (found - np.asarray(self.centre)) * scale

        def residuals(parameters: Floats) -> Floats:
            return (rotation_angles(parameters, spot) - measured).ravel()

        def jacobian(parameters: Floats) -> Floats:
            return rotation_jacobian(parameters, spot).reshape(-1, 5)

        solution = least_squares(
            residuals,
            np.zeros(5),
            jac=jacobian,
            method="lm",
            ftol=TOLERANCE,
            xtol=TOLERANCE,
            gtol=TOLERANCE,
            max_nfev=MAX_EVALUATIONS,
        )
        stretch, alpha_0, beta_0, x_zp, y_zp = solution.x
        if not solution.success or not np.isfinite(solution.x).all() or stretch <= -1:
            raise UnusableDataError(
                f"{self.about.name}: the fit did not converge ({solution.message})"
            )
        _require_settled(jacobian(solution.x), self.about.name)

        self.focal_length_error_mm_ = float(stretch * self.focal_length_mm)
        self.boresight_deg_ = (float(np.degrees(alpha_0)), float(np.degrees(beta_0)))
        self.zero_point_ = (
            float(self.centre[0] + x_zp / scale),
            float(self.centre[1] + y_zp / scale),
        )
        self.residual_rms_deg_ = float(np.degrees(np.sqrt(np.mean(solution.fun**2))))
        return self

    def predict(self, features: ArrayLike) -> Floats:
        """Sun unit vectors (N, 3) of features (N, 2)."""
        require_fitted(self, "boresight_deg_")
        found = as_features(features, 2, self.about.name)
        spot = (found - np.asarray(self.zero_point_)) * (self.unit_mm / self.focal_length_mm)
        parameters = np.array(
            [
                self.focal_length_error_mm_ / self.focal_length_mm,
                *np.radians(self.boresight_deg_),
                0.0,
                0.0,
            ]
        )
        return sun_from_rotations(np.degrees(rotation_angles(parameters, spot)))


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


def rotation_jacobian(parameters: Floats, spot: Floats) -> Floats:
    """Return the derivatives (N, 2, 5) of `rotation_angles` by its parameters."""
    stretch, alpha_0, beta_0, x_zp, y_zp = parameters
    focal = 1.0 + stretch
    x = (spot[:, 0] - x_zp) / focal
    y = (spot[:, 1] - y_zp) / focal
    across = x + np.tan(beta_0)
    along = y + np.tan(alpha_0) / np.cos(beta_0)
    cosine = 1.0 / np.hypot(1.0, across)  # of beta_m + beta_0
    height = along * cosine  # tan(alpha_m + alpha_0)

    by_across = np.zeros((len(spot), 5))
    by_across[:, 0] = -x / focal
    by_across[:, 2] = 1.0 / np.cos(beta_0) ** 2
    by_across[:, 3] = -1.0 / focal
    by_along = np.zeros((len(spot), 5))
    by_along[:, 0] = -y / focal
    by_along[:, 1] = 1.0 / (np.cos(alpha_0) ** 2 * np.cos(beta_0))
    by_along[:, 2] = np.tan(alpha_0) * np.sin(beta_0) / np.cos(beta_0) ** 2
    by_along[:, 4] = -1.0 / focal

    jacobian = np.empty((len(spot), 2, 5))
    jacobian[:, 1] = by_across * (cosine**2)[:, None]
    jacobian[:, 1, 2] -= 1.0
    by_height = cosine[:, None] * by_along - (along * across * cosine**3)[:, None] * by_across
    jacobian[:, 0] = by_height / (1.0 + height**2)[:, None]
    jacobian[:, 0, 1] -= 1.0
    return jacobian


def _require_settled(jacobian: Floats, by: str) -> None:
    lengths = np.linalg.norm(jacobian, axis=0)
    settled = bool((lengths > 0).all())
    if settled:
        values = np.linalg.svd(jacobian / lengths, compute_uv=False)
        settled = bool(values[-1] * WORST_CONDITION > values[0])
    if not settled:
        raise UnusableDataError(
            f"{by}: the calibration samples do not settle the five parameters; "
            "they must spread over the field of view"
        )
