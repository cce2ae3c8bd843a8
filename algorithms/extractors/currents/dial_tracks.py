"""Signals of the photodiodes behind a code dial's tracks, as they are (Direct)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, Self

from numpy.typing import ArrayLike

from algorithms.contract import (
    AboutExtractor,
    Extractor,
    FeatureKind,
    Floats,
    Observation,
    SensorGeometry,
)
from algorithms.documented import documented
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.parameters import require_at_least

FINE_TRACKS = 4
"""F1 to F4 of eq:fourier, after the coarse tracks of each dial."""


@documented
@dataclass(frozen=True)
class DialTracks(Extractor):
    """Calibrated signals of all tracks of the code dials: dark reading subtracted, divided by gain.

    The light behind a track measures the overlap of its pattern with the light of the slit; the
    model interprets the pattern.

    Parameters
    ----------
    bits : int
        Coarse tracks of each dial, at least 1.
    axes : tuple of {"x", "y"}
        Detector axis along which each dial lies, in the order of the readings.
    dark : float or tuple of float
        Reading without light, in the reading's unit: one for all tracks or one a track.
    gain : float or tuple of float
        Reading per unit of signal, positive, likewise.

    Notes
    -----
    Implements: fe:direct (Fan2013): ``I = (Q - Q_dark) / G``; the survey states it in words only.

    Shapes: readings (N, K), K = (bits + 4) a dial, coarse tracks first and then F1 to F4, to
    signals (N, K) in the same order, in the readings' unit over that of `gain`.

    Failure: a NaN row where a reading is NaN, infinite or saturated, or where no signal is
    positive.

    Cost: 2 operations per track.

    Examples
    --------
    >>> tracks = DialTracks(bits=2, axes=("x",), dark=10.0, gain=100.0)
    >>> tracks.extract([[110.0, 10.0, 60.0, 85.0, 60.0, 35.0]])
    array([[1.  , 0.  , 0.5 , 0.75, 0.5 , 0.25]])
    """

    about: ClassVar = AboutExtractor(
        name="dial-tracks",
        taxonomy="Direct",
        studies=("Fan2013",),
        labels=("fe:direct",),
        origin="survey",
        needs=("code_bits", "line_axes"),
        observation=Observation.CURRENTS,
        kind=FeatureKind.SIGNALS,
    )

    bits: int = 5
    axes: tuple[Literal["x", "y"], ...] = ("x", "y")
    dark: float | tuple[float, ...] = 0.0
    gain: float | tuple[float, ...] = 1.0
    saturation: float | None = None

    def __post_init__(self) -> None:
        require_at_least(self.about.name, 1, bits=self.bits)
        if not self.axes or len(set(self.axes)) < len(self.axes) or set(self.axes) - {"x", "y"}:
            raise ValueError(
                f"{self.about.name}: axes must be 'x' or 'y', each once; got {self.axes!r}"
            )
        self._direct()

    @property
    def features(self) -> tuple[str, ...]:
        """One name a track, in the order of the readings."""
        tracks = [f"bit_{bit}" for bit in range(1, self.bits + 1)]
        tracks += [f"fine_{row}" for row in range(1, FINE_TRACKS + 1)]
        return tuple(f"{axis}_{track}" for axis in self.axes for track in tracks)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        """All tracks of the sensor's dials; signals as read."""
        geometry.require("code_bits", "line_axes", by=cls.about.name)
        return cls(bits=geometry.code_bits or 0, axes=geometry.line_axes or ())

    def extract(self, observations: ArrayLike) -> Floats:
        """Signals (N, K) of readings (N, K); ValueError on wrong input."""
        return self._direct().extract(observations)

    def _direct(self) -> DirectSignals:
        return DirectSignals(
            elements=(self.bits + FINE_TRACKS) * len(self.axes),
            dark=self.dark,
            gain=self.gain,
            saturation=self.saturation,
        )
