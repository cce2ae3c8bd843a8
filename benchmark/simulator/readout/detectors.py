"""Detectors as data: angular response, pixels, quadrants, dark current and converters."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from algorithms.contract import Floats

Response = Literal["cosine", "kelly"]


def cosine_response(cosine: Floats) -> Floats:
    """Return Lambert's response: the cosine of incidence, nothing from behind."""
    return np.maximum(cosine, 0.0)


def kelly_response(cosine: Floats) -> Floats:
    """Return the Kelly cosine (eq:kellycos, Yousefian2017).

    ``-0.369 c^3 + 0.637 c^2 + 0.750 c - 0.015`` of the cosine c of incidence.

    Zero where the polynomial is negative: within 1.1 deg of grazing and behind. At normal
    incidence it is 1.003, as printed.
    """
    c = np.maximum(cosine, 0.0)
    return np.maximum(((-0.369 * c + 0.637) * c + 0.750) * c - 0.015, 0.0)


RESPONSES: dict[str, Callable[[Floats], Floats]] = {
    "cosine": cosine_response,
    "kelly": kelly_response,
}


@dataclass(frozen=True)
class DarkCurrent:
    """Signal without light, doubling every `doubling_k` kelvin.

    `at_25_c` is in electrons per second a pixel (pixel arrays) or microamperes (photodiodes).
    """

    at_25_c: float
    doubling_k: float = 7.0
    temperature_c: float = 25.0

    def level(self) -> float:
        """At the present temperature, same unit as `at_25_c`."""
        return self.at_25_c * math.pow(2.0, (self.temperature_c - 25.0) / self.doubling_k)


@dataclass(frozen=True)
class PixelArray:
    """A CMOS pixel array with its conversion to digital numbers.

    Attributes
    ----------
    columns, rows
        Of the whole detector.
    pitch_mm
        Square pixels, fully sensitive.
    sunlit_e
        Electrons in a fully lit pixel at normal incidence, mean sunlight, no glass.
    full_well_e
        A pixel holds no more.
    prnu, dsnu
        Standard deviation over pixels of the relative gain, and of the dark current in units
        of its mean.
    dark
        Per second; `exposure_s` turns it into electrons.
    read_noise_e
        Standard deviation a pixel.
    gain_e_per_dn, offset_dn, bits
        The converter: ``DN = round(offset + e / gain)`` clipped to [0, 2^bits - 1].
    """

    columns: int
    rows: int
    pitch_mm: float
    sunlit_e: float
    full_well_e: float
    prnu: float
    dsnu: float
    dark: DarkCurrent
    exposure_s: float
    read_noise_e: float
    gain_e_per_dn: float
    offset_dn: float
    bits: int

    @property
    def centre_px(self) -> tuple[float, float]:
        """Detector coordinate of the array's middle."""
        return (self.columns - 1) / 2.0, (self.rows - 1) / 2.0

    @property
    def full_scale_dn(self) -> int:
        """Largest digital number."""
        return int(2**self.bits - 1)

    @property
    def last_code_dn(self) -> int:
        """Largest digital number that can come: the converter's, or that of a full well."""
        full = round(self.offset_dn + self.full_well_e / self.gain_e_per_dn)
        return min(self.full_scale_dn, full)


@dataclass(frozen=True)
class CurrentReadout:
    """Photodiode amplifiers and their converter, one channel an element.

    Attributes
    ----------
    sunlit_ua
        Current of the whole lit aperture (quadrants) or of one element (faces) at normal
        incidence in mean sunlight, microamperes.
    gain_mismatch
        Standard deviation over elements of the relative gain.
    noise_ua
        Amplifier noise, standard deviation.
    integration_s
        Time over which shot noise averages.
    full_scale_ua, bits
        The converter is bipolar: codes cover +-full scale, so dark noise is not clipped.
    dark
        Microamperes; offset of every element.
    """

    sunlit_ua: float
    gain_mismatch: float
    noise_ua: float
    full_scale_ua: float
    bits: int
    integration_s: float = 1e-3
    dark: DarkCurrent = field(default_factory=lambda: DarkCurrent(0.0))

    @property
    def step_ua(self) -> float:
        """One code."""
        return 2.0 * self.full_scale_ua / 2.0**self.bits

    @property
    def electron_ua(self) -> float:
        """Current of one electron an integration time."""
        return 1.602176634e-13 / self.integration_s


@dataclass(frozen=True)
class Quadrants:
    """Four square photodiodes, `gap_mm` apart, on a square of `half_width_mm` half side.

    Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y) in the detector frame, the order for which
    alg:VB gives the x balance as (Q2 + Q3 - Q1 - Q4) / sum and the y balance as
    (Q1 + Q2 - Q3 - Q4) / sum.
    """

    half_width_mm: float
    gap_mm: float

    def __post_init__(self) -> None:
        if not 0 <= self.gap_mm < 2 * self.half_width_mm:
            raise ValueError(f"gap_mm must be in [0, {2 * self.half_width_mm}); got {self.gap_mm}")

    def boxes(self) -> Floats:
        """(4, 4): x_min, x_max, y_min, y_max of Q1..Q4, mm."""
        near, far = self.gap_mm / 2.0, self.half_width_mm
        return np.array(
            [
                (-far, -near, near, far),
                (near, far, near, far),
                (near, far, -far, -near),
                (-far, -near, -far, -near),
            ]
        )
