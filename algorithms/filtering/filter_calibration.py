"""What all filters of a sensor learn alike of its calibration."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats, UnusableDataError
from algorithms.filtering.drift import Gyroscope
from algorithms.filtering.reading_noise import correlated_steps
from algorithms.filtering.readings import FaceReadings, SpotReadings
from algorithms.filtering.sun_space import SunSpace

#: Directions tried at a series' first reading.
_STARTS = 256


@dataclass(frozen=True)
class FilterCalibration:
    """How a sensor reads a Sun, how far its calibration is off that, and when it was.

    Attributes
    ----------
    readings : FaceReadings or SpotReadings
        How the sensor reads a direction.
    noise, steps : ndarray, shape (m,)
        Variance of what is left of each reading, and steps over which that is correlated.
    calibrated_s, step_s : float
        Mean time of the samples, and between them.
    starts : ndarray, shape (G, 3)
        Directions among them, one in so many.
    """

    readings: FaceReadings | SpotReadings
    noise: Floats
    steps: Floats
    calibrated_s: float
    step_s: float
    starts: Floats

    @classmethod
    def from_calibration(
        cls,
        normals: Floats,
        features: Floats,
        sun: Floats,
        known: Floats,
        time_s: Floats,
        *,
        by: str,
    ) -> FilterCalibration:
        """Learn of features (n, m) of Suns (n, 3), with what is known (n, 7), in order of time.

        Parameters
        ----------
        normals : ndarray, shape (K, 3)
            Of faces; none for a spot or balance.
        features, sun, known, time_s : ndarray
            Of the calibration.
        by : str
            Whose, for messages.

        Raises
        ------
        UnusableDataError
            Where the samples do not settle how the sensor reads a Sun, or do not follow each other.
        """
        readings: FaceReadings | SpotReadings
        if len(normals):
            readings = FaceReadings.from_calibration(normals, features, sun, known, by)
        else:
            readings = SpotReadings.from_calibration(features, sun, known, by)
        residuals = features - _explained(readings, sun, known)
        step_s = float(np.median(np.diff(time_s)))
        if not step_s > 0:
            raise UnusableDataError(f"{by}: the calibration's samples must follow each other")
        chosen = np.linspace(0, len(sun) - 1, min(_STARTS, len(sun))).round().astype(int)
        return cls(
            readings,
            np.maximum((residuals**2).mean(axis=0), least_variance(features)),
            correlated_steps(residuals),
            float(time_s.mean()),
            step_s,
            sun[chosen],
        )


def least_variance(features: Floats) -> float:
    """Return the variance that rounding may have left of features."""
    return (1e-9 * float(np.abs(features).max())) ** 2


def _explained(readings: FaceReadings | SpotReadings, sun: Floats, known: Floats) -> Floats:
    """Give readings (n, m) of known Suns."""
    space = SunSpace(readings, np.eye(readings.count), Gyroscope(1.0, 1.0, 1.0), ())
    states = space.states_towards(sun)
    known = known - np.array([0.0] * 6 + [readings.middle_k])
    rows = [space.predict_readings(states[n : n + 1], known[n]) for n in range(len(sun))]
    return np.concatenate(rows)
