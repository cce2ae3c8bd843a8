"""Signals of a few photodiodes: as they are (Direct) and balanced over a quadrant (alg:VB)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.documented import documented
from algorithms.inputs import as_currents
from algorithms.parameters import require_at_least, require_choice
from algorithms.row_arithmetic import quotient_rows

Normalisation = Literal["none", "sum", "maximum", "length"]


@documented
@dataclass(frozen=True)
class DirectSignals(Extractor):
    """Calibrated signal of each photodiode: dark reading subtracted, divided by gain, normalised.

    Each reading is proportional to the irradiance projected on its detector. Offset and gain of the
    transimpedance amplifier are removed, so equal light gives equal signals.

    Parameters
    ----------
    elements : int
        Number of detector elements K, at least 1.
    dark : float or tuple of float
        Reading without light, in the reading's unit: one for all elements or one an element.
    gain : float or tuple of float
        Reading per unit of signal, positive (the transimpedance in ohm for voltages, times the
        current at full Sun to have the signal in units of one Sun; a frequency's Hz per unit).
    normalisation : {"none", "sum", "maximum", "length"}
        Divisor of the signals of each row: none, their sum, the largest, or their Euclidean length.

    Notes
    -----
    Implements: fe:direct (Allgeier2009): ``Q = G I + Q_dark``, so ``I = (Q - Q_dark) / G``; the
    survey states it in words only.

    Shapes: readings (N, K), currents, voltages or frequencies, to signals (N, K), dimensionless
    unless `normalisation` is "none" and `gain` carries a unit.

    Failure: a NaN row where a reading is NaN, infinite or saturated, or where no signal is
    positive, or where the sum to normalise by is not positive. Other light (albedo) is not
    distinguished from sunlight.

    Cost: 3 operations per element.

    Examples
    --------
    >>> photodiodes = DirectSignals(elements=3, dark=0.1, gain=2.0)
    >>> photodiodes.extract([[2.1, 1.1, 0.1], [0.1, 0.1, 0.1]])
    array([[1. , 0.5, 0. ],
           [nan, nan, nan]])
    """

    about: ClassVar = AboutExtractor(
        name="direct",
        taxonomy="Direct",
        studies=("Allgeier2009",),
        labels=("fe:direct",),
        origin="survey",
        needs=("face_normals",),
        observation=Observation.CURRENTS,
        kind=FeatureKind.SIGNALS,
    )

    elements: int = 6
    dark: float | tuple[float, ...] = 0.0
    gain: float | tuple[float, ...] = 1.0
    normalisation: Normalisation = "none"
    saturation: float | None = None

    def __post_init__(self) -> None:
        require_at_least(self.about.name, 1, elements=self.elements)
        require_choice(self.about.name, Normalisation, normalisation=self.normalisation)
        _require_calibration(self.about.name, self.elements, self.dark, self.gain)

    @property
    def features(self) -> tuple[str, ...]:
        """One name an element, in the order of the readings."""
        return tuple(f"signal_{index}" for index in range(1, self.elements + 1))

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """One element a face; signals as read, without dark reading or gain."""
        geometry.require("face_normals", by=cls.about.name)
        return cls(elements=len(geometry.face_normals or ()))

    def extract(self, observations: ArrayLike) -> Floats:
        """Signals (N, K) of readings (N, K); ValueError on wrong input."""
        readings = as_currents(observations, self.elements, self.about.name)
        signals = _calibrate(readings, self.dark, self.gain, self.saturation)
        found = (signals > 0).any(axis=1)
        if self.normalisation == "sum":
            divisor = signals.sum(axis=1)
        elif self.normalisation == "maximum":
            divisor = signals.max(axis=1)
        elif self.normalisation == "length":
            divisor = np.linalg.norm(signals, axis=1)
        else:
            divisor = np.ones(len(signals))
        found &= divisor > 0
        return quotient_rows(signals, divisor, found)


@documented
@dataclass(frozen=True)
class VoltageBalance(Extractor):
    """Balances of a quadrant photodiode: normalised displacement of the spot along x and y.

    The difference of two halves over the sum of all four is free of the light's strength, and
    proportional to the tangent of the Sun angle behind a square aperture.

    Parameters
    ----------
    order : tuple of four int
        Column (0 to 3) of the quadrants Q1, Q2, Q3, Q4. In the detector frame, where the spot
        falls at ``X = h tan(beta)``, ``Y = h tan(alpha)``, they lie at Q1 (-x, +y), Q2 (+x, +y),
        Q3 (+x, -y) and Q4 (-x, -y).
    dark : float or tuple of four float
        Reading without light, in the reading's unit, by column.
    gain : float or tuple of four float
        Reading per unit of light, positive, by column (transimpedance, or its mismatch).

    Notes
    -----
    Implements: alg:VB (fe:vb, Boslooper2017): ``s_a = (Q2 + Q3 - Q1 - Q4) / sum Q`` along x, ``s_b
    = (Q1 + Q2 - Q3 - Q4) / sum Q`` along y. The survey prints ``S_A = tan(alpha) /
    tan(alpha_MAX)`` for its x axis with ``alpha_MAX = d / (2 h)``; corrected because
    ``tan(alpha_MAX) = d / (2 h)``, and because x goes with beta here: ``s_a = 2 h tan(beta) / d``
    and ``s_b = 2 h tan(alpha) / d``, exact for a square aperture of width d.

    Shapes: readings (N, 4), currents or voltages, to ``(s_a, s_b)`` (N, 2), dimensionless, in
    [-1, 1] while no reading is below dark.

    Failure: a NaN row where a reading is NaN, infinite or saturated, or where the sum is not
    positive. At -1 or 1 all light is on one half and only the direction is known.

    Cost: 17 operations per sample.

    Examples
    --------
    >>> VoltageBalance().extract([[1.0, 3.0, 2.0, 2.0], [0.0, 0.0, 0.0, 0.0]])
    array([[0.25, 0.  ],
           [ nan,  nan]])
    """

    about: ClassVar = AboutExtractor(
        name="voltage-balance",
        taxonomy="Voltage balance",
        studies=("Boslooper2017",),
        labels=("fe:vb", "alg:VB"),
        origin="survey",
        observation=Observation.CURRENTS,
        kind=FeatureKind.BALANCE,
    )

    order: tuple[int, int, int, int] = (0, 1, 2, 3)
    dark: float | tuple[float, ...] = 0.0
    gain: float | tuple[float, ...] = 1.0
    saturation: float | None = None

    def __post_init__(self) -> None:
        if sorted(self.order) != [0, 1, 2, 3]:
            raise ValueError(
                f"{self.about.name}: order must hold the columns 0, 1, 2 and 3 once each; "
                f"got {self.order!r}"
            )
        _require_calibration(self.about.name, 4, self.dark, self.gain)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """Return the published method, readings in the order Q1 to Q4.

        UnsuitableDesignError where the sensor has no detector plane but faces, and not four of
        them, or where its elements lie behind a code dial.
        """
        if geometry.code_bits is not None:
            raise UnsuitableDesignError(
                f"{cls.about.name} reads four quadrants; the sensor has a code dial"
            )
        faces = geometry.face_normals
        if geometry.focal_length_mm is None and faces is not None and len(faces) != 4:
            raise UnsuitableDesignError(
                f"{cls.about.name} reads four quadrants; the sensor has {len(faces)} faces"
            )
        return cls()

    def extract(self, observations: ArrayLike) -> Floats:
        """Balances (N, 2) of readings (N, 4); ValueError on wrong input."""
        readings = as_currents(observations, 4, self.about.name)
        light = _calibrate(readings, self.dark, self.gain, self.saturation)
        q1, q2, q3, q4 = light[:, list(self.order)].T
        total = q1 + q2 + q3 + q4
        differences = np.column_stack([(q2 + q3) - (q1 + q4), (q1 + q2) - (q3 + q4)])
        return quotient_rows(differences, total, total > 0)


def _calibrate(
    readings: Floats,
    dark: float | tuple[float, ...],
    gain: float | tuple[float, ...],
    saturation: float | None,
) -> Floats:
    """Return ``(readings - dark) / gain``; a NaN row where one is not finite or is saturated."""
    unusable = ~np.isfinite(readings).all(axis=1)
    if saturation is not None:
        unusable |= (readings >= saturation).any(axis=1)
    readings[unusable] = np.nan
    return np.asarray((readings - np.asarray(dark)) / np.asarray(gain), dtype=np.float64)


def _require_calibration(
    by: str, elements: int, dark: float | tuple[float, ...], gain: float | tuple[float, ...]
) -> None:
    """Raise ValueError unless dark and gain are finite, gain positive, one or one an element."""
    for parameter, value in (("dark", dark), ("gain", gain)):
        if np.shape(value) not in ((), (elements,)):
            raise ValueError(f"{by}: {parameter} must be one number or {elements}; got {value!r}")
        if not np.isfinite(value).all():
            raise ValueError(f"{by}: {parameter} must be finite; got {value!r}")
    if not (np.asarray(gain) > 0).all():
        raise ValueError(f"{by}: gain must be positive; got {gain!r}")
