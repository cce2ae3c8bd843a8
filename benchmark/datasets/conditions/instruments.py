"""What the other instruments of a satellite are off by: attitude, magnetometer, thermometer."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.datasets.calibration import Name, rotation, turned_by
from benchmark.seeds import generator
from benchmark.simulator.flight.magnetic_field import Quadrupole
from benchmark.simulator.light.sun_disc import tangent_axes


@dataclass(frozen=True)
class Instruments:
    """Errors beyond the white noise of magnetometer and horizon sensor, which a `Flight` states.

    Every size is a standard deviation; what is fixed is drawn once for a unit, and is the same on
    both splits. Round numbers of what small satellites carry: a star tracker good to hundredths
    of a degree across the spacecraft's structure, a magnetometer beside currents and magnets that
    are nearly known, a digital thermometer glued to the sensor's housing.

    Attributes
    ----------
    attitude_random_deg, attitude_bias_deg
        Of the direction to the Sun that the calibration split is given, from attitude and
        almanac: a tangent axis anew for every sample, and a fixed rotation about each axis of
        the body.
    magnetometer_bias_nt
        A component, body frame.
    field_difference_nt
        Root mean square over the orbit's sphere of what Earth's true field has beyond the model
        that `magnetic_field_inertial_nT` gives: a quadrupole. The same for every unit.
    thermometer_bias_k, thermometer_noise_k, thermometer_step_k
        Fixed, anew for every sample, and of the digits.
    """

    attitude_random_deg: float = 0.02
    attitude_bias_deg: float = 0.02
    magnetometer_bias_nt: float = 300.0
    field_difference_nt: float = 300.0
    thermometer_bias_k: float = 1.0
    thermometer_noise_k: float = 0.2
    thermometer_step_k: float = 0.25

    def __post_init__(self) -> None:
        for name, value in dataclasses.asdict(self).items():
            if not (math.isfinite(value) and value >= 0):
                raise ValueError(f"{name} must be finite, not negative; got {value}")

    def report(self, sun: Floats, *names: Name) -> Floats:
        """(N, 3) unit vectors to the Sun that attitude and almanac give, for true ones (N, 3)."""
        random = math.tan(math.radians(self.attitude_random_deg))
        tilt = random * generator(*names, "attitude").standard_normal((len(sun), 2))
        first, second = tangent_axes(sun)
        seen = sun + tilt[:, :1] * first + tilt[:, 1:] * second
        bias = math.radians(self.attitude_bias_deg) * self._fix("attitude", *names)
        return turned_by(rotation(*bias.tolist()), seen)

    def systematic_deg(self, sun: Floats) -> float:
        """Root mean square of the fixed rotation's effect, ``sqrt(2)`` times its size an axis."""
        del sun
        return math.sqrt(2.0) * self.attitude_bias_deg

    def magnetometer_offset_nt(self, *names: Name) -> Floats:
        """(3,) what the magnetometer adds to every reading, body frame."""
        return self.magnetometer_bias_nt * self._fix("magnetometer", *names)

    def missing_field(self, distance_km: float, *names: Name) -> Quadrupole:
        """Return what the model of Earth's field leaves out, so strong this far from the centre."""
        return Quadrupole.drawn(self.field_difference_nt, distance_km, *names, "field")

    def thermometer_k(
        self, temperature_k: Floats, fixed: tuple[Name, ...], noise: tuple[Name, ...]
    ) -> Floats:
        """(N,) what the thermometer says of temperatures (N,).

        `fixed` and `noise` name what is drawn for the unit and for the split.
        """
        bias = self.thermometer_bias_k * float(self._fix("thermometer", *fixed)[0])
        drawn = generator(*noise, "thermometer").standard_normal(len(temperature_k))
        read = temperature_k + bias + self.thermometer_noise_k * drawn
        step = self.thermometer_step_k
        return np.asarray(np.round(read / step) * step if step else read)

    def _fix(self, what: str, *names: Name) -> Floats:
        return generator(*names, what, "bias").standard_normal(3)


#: What the standard data sets in orbit are flown with.
ABOARD = Instruments()
