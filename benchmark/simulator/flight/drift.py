"""What changes while a sensor flies: its temperature, its photodiodes, its assembly."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.flight.orbit import CircularOrbit
from benchmark.simulator.readout.detectors import DarkCurrent

#: Of 25 deg C, where drifts are zero and dark currents are stated.
REFERENCE_K = 298.15


@dataclass(frozen=True)
class ThermalCycle:
    """A small body that relaxes towards one temperature in sunlight and one in eclipse.

    Attributes
    ----------
    sunlit_k, eclipse_k
        Where it would settle.
    time_constant_s
        Of the exponential approach.
    """

    sunlit_k: float = 308.15
    eclipse_k: float = 248.15
    time_constant_s: float = 2000.0

    def __post_init__(self) -> None:
        if not (min(self.sunlit_k, self.eclipse_k) > 0 and self.time_constant_s > 0):
            raise ValueError(
                "sunlit_k, eclipse_k and time_constant_s must be positive; got "
                f"{self.sunlit_k}, {self.eclipse_k} and {self.time_constant_s}"
            )

    def temperature(self, orbit: CircularOrbit, sun: Floats, time_s: Floats) -> Floats:
        """Kelvin (N,) at times (N,), after so many orbits that every one is like the last.

        In eclipse ``C + (T_in - C) exp(-t / tau)``, in sunlight ``W + (T_out - W) exp(-t / tau)``
        with t since entry and exit, C and W where it would settle, and T_in, T_out such that the
        curve closes.
        """
        warm, cold, tau = self.sunlit_k, self.eclipse_k, self.time_constant_s
        period, rate = orbit.period_s, math.tau / orbit.period_s
        dark = 2.0 * orbit.eclipse_half_width(sun) / rate
        if dark == 0:
            return np.full(len(time_s), warm)
        kept_dark, kept_lit = math.exp(-dark / tau), math.exp(-(period - dark) / tau)
        entry = (warm * (1 - kept_lit) + cold * (1 - kept_dark) * kept_lit) / (
            1 - kept_lit * kept_dark
        )
        leaving = cold + (entry - cold) * kept_dark
        start = orbit.eclipse_entry(sun)
        out = np.empty(len(time_s))
        for n, phase in enumerate(orbit.phases(time_s)):
            since = ((float(phase) - start) % math.tau) / rate
            if since < dark:
                out[n] = cold + (entry - cold) * math.exp(-since / tau)
            else:
                out[n] = warm + (leaving - warm) * math.exp(-(since - dark) / tau)
        return out


@dataclass(frozen=True)
class PhotodiodeDrift:
    """How photodiodes' responsivities follow temperature and age; none at 25 deg C when new.

    Attributes
    ----------
    gain_per_k, gain_per_k_spread
        Mean over elements and standard deviation of the relative change a kelvin.
    loss_per_year, loss_per_year_spread
        The same of the response lost in a year of sunlight and radiation.
    """

    gain_per_k: float = 0.0
    gain_per_k_spread: float = 0.0
    loss_per_year: float = 0.0
    loss_per_year_spread: float = 0.0

    def drawn(self, count: int, *names: str | int) -> dict[str, Floats]:
        """``gain_per_k`` and ``loss_per_year`` (K,), those of the elements of one unit."""
        spread = generator(*names, "drift").standard_normal((2, count))
        return {
            "gain_per_k": self.gain_per_k + self.gain_per_k_spread * spread[0],
            "loss_per_year": self.loss_per_year + self.loss_per_year_spread * spread[1],
        }

    def slopes(
        self, gain_spread: float, light: Floats, warmer_k: Floats, age_years: Floats
    ) -> Floats:
        """(N, K, 3) changes of `light` (N, K) by one standard deviation of what elements differ by.

        Of their relative gains, which have `gain_spread`, and of their drifts a kelvin and a year.
        """
        warmed = self.gain_per_k_spread * warmer_k
        aged = -self.loss_per_year_spread * age_years
        unknown = np.broadcast_arrays(np.asarray(gain_spread), warmed, aged, light)[:3]
        return np.asarray(light[..., None] * np.stack(unknown, axis=-1))

    def factors(
        self, temperature_k: Floats, age_years: Floats, per_k: Floats, per_year: Floats
    ) -> Floats:
        """(N, K) relative responsivities for elements' own coefficients (K,)."""
        warmed = 1.0 + (temperature_k[:, None] - REFERENCE_K) * per_k
        return np.asarray(warmed * (1.0 - age_years[:, None] * per_year))


@dataclass(frozen=True)
class AssemblyDrift:
    """How the head moves with temperature and creeps with age; not at all at 25 deg C when new.

    Rates of tilt about the reference x and y axes, of the distance from mask to detector, and of
    the mask's shift against the detector: a kelvin and a year.
    """

    tilt_x_deg_k: float = 0.0
    tilt_y_deg_k: float = 0.0
    focal_length_mm_k: float = 0.0
    offset_x_mm_k: float = 0.0
    offset_y_mm_k: float = 0.0
    tilt_x_deg_year: float = 0.0
    tilt_y_deg_year: float = 0.0
    focal_length_mm_year: float = 0.0
    offset_x_mm_year: float = 0.0
    offset_y_mm_year: float = 0.0

    def moved(self, temperature_k: Floats, age_years: Floats) -> Floats:
        """(N, 5): tilts x and y (deg), focal length, offsets x and y (mm), all to be added."""
        a_kelvin = np.array(
            [
                self.tilt_x_deg_k,
                self.tilt_y_deg_k,
                self.focal_length_mm_k,
                self.offset_x_mm_k,
                self.offset_y_mm_k,
            ]
        )
        a_year = np.array(
            [
                self.tilt_x_deg_year,
                self.tilt_y_deg_year,
                self.focal_length_mm_year,
                self.offset_x_mm_year,
                self.offset_y_mm_year,
            ]
        )
        warmed = (temperature_k[:, None] - REFERENCE_K) * a_kelvin
        return np.asarray(warmed + age_years[:, None] * a_year)


def dark_levels(dark: DarkCurrent, temperature_k: Floats) -> Floats:
    """(N,) dark signal at temperatures (N,), in the unit of `dark`; its own temperature is moot."""
    return np.array(
        [
            dark.at_25_c * math.pow(2.0, (float(kelvin) - REFERENCE_K) / dark.doubling_k)
            for kelvin in temperature_k
        ]
    )
