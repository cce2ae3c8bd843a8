"""Unscented Kalman filter of the Sun's direction (UKF)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.filtering.sequence import CONTEXT, SunFilter

if TYPE_CHECKING:
    from algorithms.filtering.filters import Filter


@dataclass
class UnscentedKalmanFilter(SunFilter):
    """Unscented Kalman filter of the Sun in a turning body.

    Covariances go through dynamics and readings by points on both sides of the estimate, so that
    their curvature counts and no derivative is needed. Points of directions lie on the sphere.

    Parameters
    ----------
    face_normals : tuple of K vectors
        Nominal unit normals of faces in the order of the features; none for spots and balances.
    angle_walk_deg_sqrt_h : float
        The gyroscope's angle random walk, positive.
    bias_deg_h : float
        Standard deviation of its bias when switched on, positive.
    bias_walk_deg_h_sqrt_h : float
        Of what its bias moves in an hour, positive.
    reference_deg : float
        1-sigma, about each axis, of a fixed turn of what told the calibration's directions,
        positive.
    gain_ageing_per_year, shift_ageing_per_year : float
        1-sigma of what a year changes, positive: a face's gain against the others', and a spot's
        offsets over the focal length.
    worst_deg : float
        1-sigma of a direction beyond which it is not answered, positive.
    kappa : float
        Spread of the points: they stand ``sqrt(n + kappa)`` standard deviations off; from 0 up.

    Attributes
    ----------
    readings_ : FaceReadings or SpotReadings
        How the sensor reads a direction.
    noise_ : ndarray, shape (m,)
        Variance of each reading.
    steps_ : ndarray, shape (m,)
        Steps over which its errors are correlated.
    calibrated_s_ : float
        Mean time of the calibration.
    starts_ : ndarray, shape (G, 3)
        Directions that the calibration saw.
    step_s_ : float
        Between its samples.
    quality_ : FitQuality
        Of the filter on its own calibration.

    Raises
    ------
    ValueError
        If a parameter is not as said above; the message names it.

    Notes
    -----
    Implements: the online section's UKF, of the filters that model:mnc names.

    State: the Sun's direction in the body frame, the gyroscope's bias and, before faces, the
    light's strength; ``s' = exp(-[(w - b) dt]) s``, ``z = h(s) + v`` with h as the calibration
    found it, warmth and the Earth's light by nadir included. The turn of the calibration's
    reference is considered, not estimated, and so is what ages.

    Shapes: signals (N, K), or spots or balances (N, 2), in the order of time, with the context's
    columns, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, in eclipse and in the dark, at the first reading of a
    series, and where the 1-sigma is beyond `worst_deg`. A series ends where time does not go on by
    a step. fit raises UnusableDataError for fewer than 60 samples in sunlight, or where these do
    not settle how the sensor reads a Sun.

    Cost: 40 us a step of the machine this was written on.

    References
    ----------
    Survey model:mnc and its section on online methods.

    Examples
    --------
    A sensor that turns about its boresight's side at 0.2 deg/s, read every 10 s.

    >>> import numpy as np
    >>> time = 10.0 * np.arange(200.0)
    >>> turn = np.radians(0.2) * time
    >>> lean = 0.5 + 0.2 * np.sin(turn / 7.0)
    >>> sun = np.column_stack([np.sin(lean) * np.cos(turn), np.sin(lean) * np.sin(turn),
    ...                        np.cos(lean)])
    >>> spots = 100.0 * sun[:, :2] / sun[:, 2:]
    >>> swing = np.degrees(np.gradient(lean, time))
    >>> context = {"time_s": time, "eclipse": 0 * time, "temperature_K": 290.0 + 5 * np.cos(turn),
    ...            "nadir": -sun, "rate_deg_s": np.column_stack(
    ...                [swing * np.sin(turn), -swing * np.cos(turn), -0.2 + 0 * time])}
    >>> model = UnscentedKalmanFilter().fit(spots, sun, context)
    >>> found = model.predict(spots, context)
    >>> int(np.isnan(found).any(axis=1).sum())  # one reading is no sequence yet
    1
    >>> bool(np.nanmax(np.abs(found - sun)) < 2e-3)
    True
    """

    about: ClassVar = AboutModel(
        name="unscented-kalman",
        taxonomy="None",
        studies=(),
        labels=("model:mnc",),
        origin="ours",
        accepts=frozenset(FeatureKind),
        context=CONTEXT,
    )

    kappa: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0 <= self.kappa < float("inf"):
            raise ValueError(f"{self.about.name}: kappa must be 0 or more; got {self.kappa!r}")

    def filter(self) -> Filter:
        """Take points on both sides."""
        from algorithms.filtering.filters import SigmaPointKalman  # noqa: PLC0415 - Numba

        return SigmaPointKalman(kappa=self.kappa, considered=self.considered())
