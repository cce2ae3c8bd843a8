"""A quadrant photodiode behind an opening that moves against it, along an orbit."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.flight.drift import (
    AssemblyDrift,
    PhotodiodeDrift,
    ThermalCycle,
)
from benchmark.simulator.flight.moved_heads import moved_heads
from benchmark.simulator.flight.time_series import (
    drift_information,
    drift_slopes,
    drifted,
    with_times,
)
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.optics.projection import ProjectedLight
from benchmark.simulator.readout.references import References
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern
from benchmark.simulator.sensors.quadrants import QuadrantSensor


@dataclass(frozen=True)
class DriftingQuadrantSensor(QuadrantSensor):
    """Quadrants whose head, gains and dark currents follow temperature and age.

    The Earth's light, a small part of the currents, is that of a head that stands still; drift
    changes a thousandth of it. The readout's own dark-current temperature is not used.

    Attributes
    ----------
    assembly, photodiodes
        How the head moves, and how responsivities change.
    thermal
        The temperatures it goes through.

    Raises
    ------
    ValueError
        Where there is a ghost, which is not moved with the head.
    """

    assembly: AssemblyDrift = field(default_factory=AssemblyDrift, kw_only=True)
    photodiodes: PhotodiodeDrift = field(default_factory=PhotodiodeDrift, kw_only=True)
    thermal: ThermalCycle = field(default_factory=ThermalCycle, kw_only=True)

    def __post_init__(self) -> None:
        if self.ghost is not None:
            raise ValueError(f"a head that drifts is simulated without a ghost; got {self.ghost!r}")

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """As `QuadrantSensor`; with ``gain_per_k`` and ``loss_per_year`` (4,), each one's own."""
        drifts = self.photodiodes.drawn(4, *names)
        return {**super().fixed_pattern(*names), **drifts}

    def project(self, scene: Scene) -> ProjectedLight:
        """As `Camera.project`, every sample with its own assembly.

        TypeError for a scene that is not a `TimedScene`.
        """
        heads = moved_heads(self.camera, self.assembly, with_times(scene, self))
        parts = [head.project(sun[None, :]) for head, sun in zip(heads, scene.sun, strict=True)]
        return ProjectedLight(
            np.concatenate([part.rims_mm for part in parts], axis=1),
            np.concatenate([part.light for part in parts]),
        )

    def earth_through(
        self, earth: Earth, nadir: Floats, scene: Scene, pattern: FixedPattern
    ) -> Floats:
        """(N, 4) light of the Earth, of a head that stands still."""
        still = QuadrantSensor(self.camera, self.detector, self.readout)
        return still.earth_through(earth, nadir, scene, pattern)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, 4) mean microamperes; TypeError for a scene that is not a `TimedScene`."""
        at = with_times(scene, self)
        return drifted(self.readout, self.photodiodes, self.receive(scene), pattern, at)

    def gain_slopes(self, expected: Floats, scene: Scene) -> Floats:
        """(N, 4, 3) microamperes by gains and by their drifts."""
        return drift_slopes(self.readout, self.photodiodes, expected, with_times(scene, self))

    def gain_information(self, references: References) -> Floats:
        """(3, 3) of the spreads and the flats, which are taken before the flight."""
        return drift_information(self.readout, self.photodiodes, references)
