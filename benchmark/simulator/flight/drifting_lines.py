"""Linear arrays behind slits whose plate moves against them, along an orbit."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.simulator.flight.drift import AssemblyDrift, ThermalCycle, dark_levels
from benchmark.simulator.flight.moved_heads import moved_heads
from benchmark.simulator.flight.time_series import with_times
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.readout.references import References, pixel_unit_variance
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.line_sensor import LineSensor


@dataclass(frozen=True)
class DriftingLineSensor(LineSensor):
    """A `LineSensor` whose head and dark signals follow temperature and age.

    The Earth's light, next to nothing behind slits, is that of a head that stands still. The
    detector's own dark-current temperature is not used.

    Attributes
    ----------
    drift
        How the head moves.
    thermal
        The temperatures it goes through.

    Raises
    ------
    ValueError
        Where there is a ghost, which is not moved with the head.
    """

    drift: AssemblyDrift = field(default_factory=AssemblyDrift, kw_only=True)
    thermal: ThermalCycle = field(default_factory=ThermalCycle, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.ghost is not None:
            raise ValueError(f"a head that drifts is simulated without a ghost; got {self.ghost!r}")

    @property
    def still(self) -> LineSensor:
        """The same sensor with a head that does not move, its dark signal at 25 deg C."""
        same = {f.name: getattr(self, f.name) for f in fields(LineSensor)}
        dark = replace(self.detector.dark, temperature_c=25.0)
        return LineSensor(**{**same, "detector": replace(self.detector, dark=dark)})

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `LineSensor`, dark signal at 25 deg C."""
        return self.still.fixed_pattern(*names)

    def lit(self, scene: Scene) -> Floats:
        """(N, W) light, as `LineSensor` has it; TypeError for a scene that is not timed."""
        heads = moved_heads(self.camera, self.drift, with_times(scene, self))
        still = self.still
        return np.concatenate(
            [replace(still, camera=head).lit(scene.part(n, n + 1)) for n, head in enumerate(heads)]
        )

    def earth_through(
        self, earth: Earth, nadir: Floats, scene: Scene, pattern: FixedPattern
    ) -> Floats:
        """(N, W) light of the Earth, of a head that stands still."""
        return self.still.earth_through(earth, nadir, scene, pattern)

    def _electrons(self, scene: Scene, pattern: FixedPattern) -> Floats:
        electrons = super()._electrons(scene, pattern)
        warmth = dark_levels(
            replace(self.detector.dark, at_25_c=1.0), with_times(scene, self).temperature_k
        )
        return np.asarray(electrons + (warmth - 1.0)[:, None] * pattern["dark_e"])

    def unit_variance(
        self, expected: Floats, scene: Scene, references: References
    ) -> NDArray[np.float64] | None:
        """As `LineSensor`; references are taken at 25 deg C, dark signals grow with warmth."""
        warmth = dark_levels(
            replace(self.detector.dark, at_25_c=1.0), with_times(scene, self).temperature_k
        )
        return pixel_unit_variance(self.still.detector, expected, references, warmth[:, None])
