"""Flat and dark frames, and what they leave unknown of a unit's elements.

An element reads ``x = g L + d`` of the light L: its relative gain g is drawn about 1, its dark
signal d about the design's. Who calibrates a unit takes a few readings in the dark and a few in
uniform light; who does not has the spread of the design alone. Elements are independent, so what
stays unknown of one only adds to the variance of its readings.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.noise import GAUSSIAN_FROM, NoiseStreams
from benchmark.simulator.readout.quantisation import ROUNDING, reading_variance

#: Fractions of a code over which readings of a calibration are spread.
_FRACTIONS = 64


@dataclass(frozen=True)
class References:
    """What a calibration offers of the unit itself, beside poses: readings in known light.

    Attributes
    ----------
    flats, darks
        Readings of every element in uniform light, and without light; 0 for none.
    level
        Light of the flats, as a share of the scale from dark to its end. Only ratios between
        elements are estimated from it: the light itself is common to all.
    """

    flats: int = 16
    darks: int = 16
    level: float = 0.5

    def __post_init__(self) -> None:
        if self.flats < 0 or self.darks < 0:
            raise ValueError(
                f"flats and darks must not be negative; got {self.flats} and {self.darks}"
            )
        if not 0 < self.level < 1:
            raise ValueError(f"level must be between 0 and 1; got {self.level}")


@dataclass(frozen=True)
class ElementSpread:
    """What is unknown of one element: variances of its relative gain and of its dark signal.

    Attributes
    ----------
    gain, cross, dark
        Variance of the gain, covariance with the dark signal, variance of that; in powers of the
        unit of the signal.
    """

    gain: float
    cross: float
    dark: float

    def variance(self, light: Floats, warmth: Floats | float = 1.0) -> Floats:
        """Variance of the mean signal of elements that get `light`, in the signal's unit squared.

        `warmth` is the dark signal in units of that of the references, where it is another.
        """
        return np.asarray(
            light * (light * self.gain + 2.0 * warmth * self.cross) + warmth**2 * self.dark
        )


def posterior(
    spread: tuple[float, float], light: float, information: tuple[float, float]
) -> ElementSpread:
    """Return what is left of the spreads after readings in the dark and in known light.

    The Gaussian posterior of (g, d): prior information, that of the darks on d, and that of the
    flats on ``g light + d``.

    Parameters
    ----------
    spread
        Standard deviations of the relative gain and of the dark signal before; 0 for known.
    light
        Signal of the flats without the dark one.
    information
        Of all flats and of all darks, on their mean reading.
    """
    gain, dark = spread
    flats, darks = information
    # in units of the spreads, so that a known one needs no infinite information
    to_gain, to_dark = gain * light, dark
    a = 1.0 + flats * to_gain**2
    b = flats * to_gain * to_dark
    c = 1.0 + (flats + darks) * to_dark**2
    determinant = a * c - b * b
    return ElementSpread(
        gain=gain**2 * c / determinant,
        cross=-gain * dark * b / determinant,
        dark=dark**2 * a / determinant,
    )


def readings_information(deviation: float, count: int) -> float:
    """Information of `count` readings of one level on it, in inverse squared codes.

    `deviation` is that of a reading before rounding, in codes. Elements lie anywhere between two
    edges of codes: the mean of the variances is inverted. However often it is repeated, a reading
    whose noise is far below a code tells which code the level is in and no more, which is what
    one reading with the variance ``deviation^2 + 1/12`` tells.
    """
    if count == 0:
        return 0.0
    if not deviation > 0:
        return 1.0 / ROUNDING
    fractions = (np.arange(_FRACTIONS) + 0.5) / _FRACTIONS
    single = reading_variance(1e6 + fractions, np.full(_FRACTIONS, deviation), 0.0, 2e6)
    variances = np.minimum(single / count, deviation**2 + ROUNDING)
    return 1.0 / math.fsum(variances.tolist()) * _FRACTIONS


def pixel_spread(detector: PixelArray, dark_e: float, references: References) -> ElementSpread:
    """Return what is unknown of a pixel in digital numbers, whose mean dark signal is `dark_e`."""
    per_dn, errors = detector.gain_e_per_dn, detector.errors
    light_e = _flat_light_e(detector, dark_e, references)
    found = []
    for mean, count in ((light_e + dark_e, references.flats), (dark_e, references.darks)):
        bent = float(errors.slope(np.asarray(mean), detector.full_well_e))
        single = bent**2 * (mean + detector.read_noise_e**2) + detector.apart_noise_e**2
        found.append(bent**2 * readings_information(math.sqrt(single) / per_dn, count))
    flat, dark = found
    # of a linear array every pixel has an offset of its own; what columns share is known apart
    own = errors.column_offset_e if detector.rows == 1 else 0.0
    spread = detector.prnu, math.hypot(detector.dsnu * dark_e, own) / per_dn
    return posterior(spread, light_e / per_dn, (flat, dark))


def pixel_unit_variance(
    detector: PixelArray,
    expected: Floats,
    references: References,
    warmth: Floats | float = 1.0,
) -> Floats:
    """Squared digital numbers that a unit's gains and dark signals add to those of `expected`."""
    dark_e = detector.dark.level() * detector.exposure_s
    dark = warmth * (dark_e / detector.gain_e_per_dn)
    left = pixel_spread(detector, dark_e, references)
    if not detector.errors.nonlinearity:
        light = np.maximum(expected - detector.offset_dn - dark, 0.0)
        return left.variance(light, warmth)
    errors, full_well_e = detector.errors, detector.full_well_e
    held = errors.held((expected - detector.offset_dn) * detector.gain_e_per_dn, full_well_e)
    light = np.maximum(held / detector.gain_e_per_dn - dark, 0.0)
    return np.asarray(errors.slope(held, full_well_e) ** 2 * left.variance(light, warmth))


def pixel_references(
    detector: PixelArray,
    pattern: Mapping[str, Floats],
    references: References,
    streams: NoiseStreams,
) -> dict[str, Floats]:
    """Mean of a unit's dark and flat readings, ``dark_dn`` and ``flat_dn``, shape of its pixels.

    Offsets of columns are in them. What there are no readings of is left out.
    """
    dark_e = detector.dark.level() * detector.exposure_s
    light = _flat_light_e(detector, dark_e, references)
    signals = {
        "dark_dn": (references.darks, pattern["dark_e"]),
        "flat_dn": (references.flats, pattern["gain"] * light + pattern["dark_e"]),
    }
    return {
        name: _mean_reading(detector, signal, count, streams, pattern.get("column_e"))
        for name, (count, signal) in signals.items()
        if count
    }


def _flat_light_e(detector: PixelArray, dark_e: float, references: References) -> float:
    end = (detector.last_code_dn - detector.offset_dn) * detector.gain_e_per_dn
    if detector.errors.nonlinearity:
        end = float(detector.errors.held(np.asarray(end), detector.full_well_e))
    return references.level * (end - dark_e)


def _mean_reading(
    detector: PixelArray,
    electrons: Floats,
    count: int,
    streams: NoiseStreams,
    column_e: Floats | None,
) -> Floats:
    from benchmark.simulator.kernels.reference_readings import add_reading  # noqa: PLC0415 - Numba

    errors, columns = detector.errors, electrons.shape[-1]
    total, mean = np.zeros(electrons.shape), np.ascontiguousarray(electrons)
    # as `draw_counts`, with all that is the same in every reading computed once
    few = ~(mean >= GAUSSIAN_FROM)
    means = np.maximum(mean[few], 0.0)
    deviation = np.sqrt(np.where(few, 0.0, mean) + detector.read_noise_e**2)
    offsets, shared = np.zeros(columns) if column_e is None else column_e, np.zeros(columns)
    numbers = (
        detector.full_well_e,
        errors.nonlinearity / detector.full_well_e,
        detector.gain_e_per_dn,
        float(detector.offset_dn),
        float(detector.full_scale_dn),
    )
    rows = (-1, columns)
    for _ in range(count):
        normal = streams.gaussian.standard_normal(mean.shape, dtype=np.float32)
        counted = np.asarray(streams.poisson.poisson(means) - means, dtype=np.float64)
        if errors.column_noise_e:
            shared = streams.column_noise(errors.column_noise_e, electrons.shape[-1:])
        add_reading(
            total.reshape(rows),
            (mean.reshape(rows), deviation.reshape(rows)),
            (normal.reshape(rows), counted),
            (offsets, shared),
            (GAUSSIAN_FROM, *numbers),
        )
    return total / count
