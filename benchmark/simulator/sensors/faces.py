"""Light on bare detector elements that face different ways, `Faces`; currents: `FaceSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.readout.currents import CurrentSensor, currents, element_gains
from benchmark.simulator.readout.detectors import RESPONSES, CurrentReadout, Response
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern

CUBE: tuple[tuple[float, float, float], ...] = (
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0),
    (0.0, -1.0, 0.0),
    (0.0, 0.0, 1.0),
    (0.0, 0.0, -1.0),
)


class Faces:
    """Light on K bare elements with outward normals, whatever turns it into a signal.

    The base of frozen dataclasses that have these fields; what they mean is said in `FaceSensor`.
    """

    normals: tuple[tuple[float, float, float], ...]
    response: Response
    normal_error_deg: float
    sun: SolarDisc
    assembly: Assembly

    def built_normals(self, *names: str | int) -> Floats:
        """(K, 3) normals of the unit of this name."""
        nominal = np.array(self.normals)
        error = generator(*names, "normals").standard_normal(nominal.shape)
        error -= np.sum(error * nominal, axis=1, keepdims=True) * nominal
        built = nominal + math.tan(math.radians(self.normal_error_deg)) * error
        return np.asarray(built / np.sqrt(np.sum(built**2, axis=1, keepdims=True)))

    def origins(self, sun: Floats, generator: np.random.Generator) -> None:
        """Nothing is windowed (the arguments are the protocol's)."""

    def lit(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) response to direct sunlight in units of mean sunlight at normal incidence.

        Integrated over the Sun's disc, so a face that the Sun's limb just reaches is not dark.
        """
        points = self.sun.directions(self.assembly.to_head(scene.sun))
        _, shares = self.sun.quadrature()
        out = np.empty((len(scene), len(self.normals)))
        for k, (x, y, z) in enumerate(pattern["normals"]):
            cosine = points[..., 0] * x + points[..., 1] * y + points[..., 2] * z
            out[:, k] = np.sum(RESPONSES[self.response](cosine) * shares, axis=1)
        return np.asarray(out * scene.irradiance[:, None])

    def earthlight(self, earth: Earth, sun: Floats, nadir: Floats, pattern: FixedPattern) -> Floats:
        """(N, K) response to the sunlit Earth for Sun and nadir directions (N, 3)."""
        head = self.assembly.to_head
        return earth.response(head(sun), head(nadir), pattern["normals"], self.response)

    def receive(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) response to all light: direct, stray and from the Earth; units as of `lit`."""
        response = self.lit(scene, pattern) + scene.stray[:, None]
        if scene.albedo is not None:
            response += scene.albedo
        return response


@dataclass(frozen=True)
class FaceSensor(CurrentSensor, Faces):
    """K maskless photodiodes with outward normals and an angular response.

    Attributes
    ----------
    normals
        (K, 3) nominal unit vectors.
    normal_error_deg
        Standard deviation a tangent axis of each built normal about its nominal one.
    response
        ``cosine`` or ``kelly``.
    """

    normals: tuple[tuple[float, float, float], ...]
    readout: CurrentReadout
    response: Response = "kelly"
    normal_error_deg: float = 0.0
    sun: SolarDisc = field(default_factory=SolarDisc)
    assembly: Assembly = field(default_factory=Assembly)

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (K,) and ``normals`` (K, 3): the unit's gains and built normals."""
        return {
            "gain": element_gains(self.readout, len(self.normals), *names),
            "normals": self.built_normals(*names),
        }

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, K) mean microamperes."""
        return currents(self.readout, self.receive(scene, pattern), pattern)
