"""Four elements around the middle of a detector behind a mask: `FourElements`."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.environment import Earth
from benchmark.simulator.optics.earthlight import EarthInView, on_elements
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import Camera, ProjectedLight
from benchmark.simulator.readout.currents import CurrentSensor, currents, element_gains
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensor import FixedPattern

#: Signs of x and y of the elements Q1..Q4.
QUADRANTS = np.array([(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)])


@dataclass(frozen=True)
class FourElements(CurrentSensor):
    """Light on four elements, one a quadrant, in the order Q1..Q4, for which alg:VB is made.

    The base of sensors with a field `readout`.
    """

    camera: Camera
    sees_slopes: ClassVar[bool] = True

    @abstractmethod
    def lit(self, scene: Scene) -> Floats:
        """(N, 4) direct light on the elements."""
        ...

    @abstractmethod
    def stray(self, scene: Scene) -> Floats:
        """(N, 4) stray light on the elements, in the units of `lit`."""
        ...

    def fixed_pattern(self, *names: str | int) -> FixedPattern:
        """``gain`` (4,): relative gains of the elements or of their amplifiers."""
        return {"gain": element_gains(self.readout, 4, *names)}

    def receive(self, scene: Scene) -> Floats:
        """(N, 4) all light: direct, stray and from the Earth; units as of `lit`."""
        response = self.lit(scene) + self.stray(scene)
        if scene.albedo is not None:
            response += scene.albedo
        return np.asarray(response)

    def earth_through(
        self,
        earth: Earth,
        nadir: Floats,
        scene: Scene,
        pattern: FixedPattern,  # noqa: ARG002 - the protocol's
    ) -> Floats:
        """(N, 4) light of the Earth, as `lit` has that of the Sun; for nadir (N, 3)."""

        def lit(camera: Camera, sky: Scene) -> Floats:
            return replace(self, camera=camera).lit(sky)

        return on_elements(self.camera, lit, EarthInView(earth, nadir, scene.sun), self)

    def expected(self, scene: Scene, pattern: FixedPattern) -> Floats:
        """(N, 4) mean microamperes."""
        return currents(self.readout, self.receive(scene), pattern)


class LitAreas(FourElements):
    """Four elements that give what area of them is lit. Its subclasses have a field `ghost`."""

    ghost: Ghost | None

    @abstractmethod
    def areas(self, projected: ProjectedLight, scene: Scene) -> Floats:
        """(N, 4) lit areas of the elements, mm^2, times the light."""
        ...

    @property
    @abstractmethod
    def open_mm2(self) -> float:
        """Area of the openings, mm^2: what all elements get at normal incidence."""
        ...

    def project(self, scene: Scene) -> ProjectedLight:
        """Return what the camera shows of a scene."""
        return self.camera.project(scene.sun)

    def lit(self, scene: Scene) -> Floats:
        """(N, 4) light on the elements, in units of the openings at normal incidence."""
        out = self.areas(self.project(scene), scene)
        if self.ghost is not None:
            out += self.areas(self.ghost.project(self.camera, scene.sun), scene)
        return np.asarray(out / self.open_mm2)
