"""Consider Kalman filter: readings whose calibration is not trusted (ECM/Noise)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from algorithms.contract import AboutModel, FeatureKind
from algorithms.filtering.drift import EARTH, GAINS, HEAD_SHIFTS, Drift
from algorithms.filtering.sequence import CONTEXT, SunFilter
from algorithms.inputs import require_positive

if TYPE_CHECKING:
    from algorithms.filtering.filters import Filter


@dataclass
class ConsiderKalmanFilter(SunFilter):
    """Extended Kalman filter that allows for a calibration that is off, and leaves it so.

    Gains and the Earth's brightness, or focal length and offsets behind a spot, are considered:
    their covariance, and what they have in common with the direction, enter every gain, but no
    reading moves them. So the filter is as unsure as it should be of errors that last.

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
    gain_deviation : float
        Of what each face's gain is off, relative, positive.
    albedo_deviation : float
        Of what the Earth's light is off, over what the calibration found, positive.
    shift_deviation : float
        Of offsets, over the focal length, and of the focal length, relative, positive.

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
    Implements: model:mnc (OKeefe2017, eq:mnoise), ``V = C (V_d + V_alpha + nu)`` with the
    calibration factors C and the strength of the albedo V_alpha considered. Survey prints V_alpha
    negative; corrected because light adds. V_d and V_alpha are as the calibration found them: a
    cubic of the cosine in place of the cosine, polynomials of nadir in place of the integral over
    the Earth (ours).

    State: the Sun's direction in the body frame, the gyroscope's bias and, before faces, the
    light's strength; ``s' = exp(-[(w - b) dt]) s``, ``z = h(s) + v`` with h as the calibration
    found it, warmth and the Earth's light by nadir included. The turn of the calibration's
    reference is considered, not estimated, and so is what ages.
    ``K = P H' S^-1`` with the rows of what is considered set to nothing; Joseph's form.

    Shapes: signals (N, K), or spots or balances (N, 2), in the order of time, with the context's
    columns, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, in eclipse and in the dark, at the first reading of a
    series, and where the 1-sigma is beyond `worst_deg`. A series ends where time does not go on by
    a step. fit raises UnusableDataError for fewer than 60 samples in sunlight, or where these do
    not settle how the sensor reads a Sun.

    Cost: 30 us a step of the machine this was written on, for six faces.

    References
    ----------
    OKeefe2017; survey model:mnc, eq:mnoise.

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
    >>> model = ConsiderKalmanFilter().fit(spots, sun, context)
    >>> found = model.predict(spots, context)
    >>> int(np.isnan(found).any(axis=1).sum())  # one reading is no sequence yet
    1
    >>> bool(np.nanmax(np.abs(found - sun)) < 2e-3)
    True
    """

    about: ClassVar = AboutModel(
        name="consider-kalman",
        taxonomy="ECM/Noise",
        studies=("OKeefe2017",),
        labels=("model:mnc", "eq:mnoise"),
        origin="survey",
        accepts=frozenset(FeatureKind),
        context=CONTEXT,
    )

    gain_deviation: float = 0.01
    albedo_deviation: float = 0.3
    shift_deviation: float = 3e-4

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(
            self.about.name,
            gain_deviation=self.gain_deviation,
            albedo_deviation=self.albedo_deviation,
            shift_deviation=self.shift_deviation,
        )

    def filter(self) -> Filter:
        """Leave what is considered as it is."""
        from algorithms.filtering.filters import ExtendedKalman  # noqa: PLC0415 - Numba

        return ExtendedKalman(self.considered())

    def uncertain(self, years: float) -> Sequence[Drift]:
        """Consider gains and the Earth, or focal length and offsets, however long ago."""
        del years
        faces = len(self.face_normals)
        if faces:
            gains = (Drift(GAINS + face, self.gain_deviation, 0.0) for face in range(faces))
            return (Drift(EARTH, self.albedo_deviation, 0.0), *gains)
        return tuple(Drift(place, self.shift_deviation, 0.0) for place in HEAD_SHIFTS)
