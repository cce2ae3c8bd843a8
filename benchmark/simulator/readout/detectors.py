"""Detectors as data: angular response, pixels, quadrants, dark current and converters."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.readout.pixel_errors import PixelErrors, drawn

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


#: Index of the oxide between a pixel's surface and its photodiode.
OXIDE_INDEX = 1.46


def tunnel_response(cosine: Floats, depth: float) -> Floats:
    """Share of the light that reaches the floor of a tunnel, by the cosine of incidence.

    A photodiode lies at the bottom of a tunnel between wires, `depth` times as deep as wide,
    filled with oxide: light that comes askew falls on the walls (pixel vignetting, Catrysse, Liu
    and El Gamal, Proc. SPIE 3965, 2000). Of a square floor a parallel beam refracted to theta'
    reaches ``1 - depth tan(theta')``, for a plane of incidence along a side. At grazing incidence
    light is 43 deg from the normal within: depths above 1.06 leave none.
    """
    c = np.maximum(cosine, 0.0)
    square = np.maximum(1.0 - c * c, 0.0) / OXIDE_INDEX**2  # of the sine, after refraction
    tangent = np.sqrt(square / (1.0 - square))
    return np.asarray(np.maximum(1.0 - depth * tangent, 0.0))


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
    errors
        What else pixels and amplifiers do. Read noise is that at the amplifiers' input: it is
        bent with the signal. A linear array's pixels count as columns, each by itself.
    tunnel
        Depth of a pixel over the width of its photodiode, which dims oblique light
        (`tunnel_response`); 0 for none.
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
    errors: PixelErrors = field(default_factory=PixelErrors)
    tunnel: float = 0.0

    def __post_init__(self) -> None:
        if not self.tunnel >= 0:
            raise ValueError(f"tunnel must not be negative; got {self.tunnel}")

    def built(self, shape: tuple[int, ...], *names: str | int) -> dict[str, Floats]:
        """Draw the pixels of the unit of this name.

        ``gain`` and ``dark_e`` of `shape`, relative and electrons; ``column_e`` (its last size)
        where columns have offsets.
        """
        gain = 1.0 + self.prnu * drawn("normal", shape, *names, "prnu")
        dark = self.dark.level() * self.exposure_s
        dark_e = dark * (1.0 + self.dsnu * drawn("normal", shape, *names, "dsnu"))
        unit = {"gain": np.maximum(gain, 0.0), "dark_e": np.maximum(dark_e, 0.0)}
        if self.errors.hot:
            unit["dark_e"] *= self.errors.dark_factor(shape, *names)
        if self.errors.column_offset_e:
            unit["column_e"] = self.errors.column_offsets(shape[-1], *names)
        return unit

    @property
    def shared_noise_e(self) -> float:
        """Noise (electrons) that all pixels of a column share; none of linear arrays."""
        return self.errors.column_noise_e if self.rows > 1 else 0.0

    @property
    def apart_noise_e(self) -> float:
        """Noise (electrons) that each pixel of a linear array has behind its amplifier."""
        return self.errors.column_noise_e if self.rows == 1 else 0.0

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
        read = float(self.errors.read(np.asarray(self.full_well_e), self.full_well_e))
        full = round(self.offset_dn + read / self.gain_e_per_dn)
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
