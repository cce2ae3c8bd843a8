"""What every simulated sensor offers to datasets and bounds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.readout.column_noise import CommonNoise
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene

#: What one built unit deviates by, array by array; the same for all its samples.
FixedPattern = Mapping[str, Floats]


class Sensor(Protocol):
    """A sensor design with its error sources; frozen dataclasses, fields = parameters."""

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """Build the unit of this name: element gains, dark currents and the like."""
        ...

    def origins(self, sun: Floats, generator: np.random.Generator) -> NDArray[np.int64] | None:
        """(N, 2) first pixel (x, y) of each sample's window; None where nothing is windowed."""
        ...

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, ...) mean observation in output units, before noise and rounding."""
        ...

    def variance(self, expected: Floats) -> Floats:
        """Variance of every element about its mean: what its reading tells, inverted."""
        ...

    def observe(self, scene: Scene, pattern: FixedPattern, streams: NoiseStreams) -> NDArray[Any]:
        """(N, ...) what the sensor puts out."""
        ...


@runtime_checkable
class UnitSpread(Protocol):
    """A sensor whose elements differ from unit to unit each by itself: in gain and dark signal."""

    def reference_readings(
        self, pattern: FixedPattern, references: References, streams: NoiseStreams
    ) -> dict[str, Floats]:
        """Mean dark and flat readings of a unit, of all its elements; names end in the unit."""
        ...


@runtime_checkable
class PixelSpread(UnitSpread, Protocol):
    """A sensor of so many elements that a calibration pose tells next to nothing of each."""

    def unit_variance(
        self, expected: Floats, scene: Scene, references: References
    ) -> Floats | None:
        """Variance, in the shape of `expected`, that the unit adds where it is not known.

        Of that mean, with what is left of the elements' spread after `references`; None where
        the elements are not independent of each other in it.
        """
        ...


@runtime_checkable
class GainSpread(UnitSpread, Protocol):
    """A sensor of a few elements: each calibration pose tells of the gain of those it lights."""

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:
        """(N, K, P) change of the means `expected` (N, K) by what is unknown of each element.

        Of P independent unknowns (its gain, how that drifts), each by one standard deviation over
        units.
        """
        ...

    def gain_information(self, references: References) -> Floats:
        """(P, P) information on an element's unknowns before any pose, in the units of the slopes.

        The spread over units, which is the identity, and the references.
        """
        ...


@runtime_checkable
class SharesNoise(Protocol):
    """A sensor whose readings may have noise in common: pixels of a column its amplifier's."""

    def common_noise(
        self, shape: tuple[int, ...], references: References | None
    ) -> CommonNoise | None:
        """Return what elements of signals of this shape share, in their unit; None for nothing.

        Of a unit that is known, or known by `references` alone.
        """
        ...


@runtime_checkable
class SeesEarth(Protocol):
    """A sensor behind openings through which the sunlit Earth shines."""

    def earth_through(
        self, earth: Earth, nadir: Floats, scene: Scene, pattern: FixedPattern
    ) -> Floats:
        """(N, ...) light of the Earth, in the units of direct light; for nadir (N, 3).

        In whatever form the sensor adds it to a `Scene` of the same samples as ``albedo``.
        """
        ...
