"""Frames of one unit under a fault whose strength is chosen; at none they are the plain frames."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark.learned.frames import Frames, Unit
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.spoofing.second_light import with_laser

#: Frames that are drawn together, and share a strength and the holes that are hidden.
GROUP = 16
#: Points an axis between which glare is bilinear.
_POINTS = 4


class FaultyUnit(Unit):
    """One unit of a data set of whole frames, which may be struck by a fault."""

    def struck(self, fault: str, strength: float, count: int, *names: str | int) -> Frames:
        """Return frames under a fault.

        Suns, noise and the fault's own draws depend on the names alone.

        Parameters
        ----------
        fault
            One of `benchmark.learned_faults.rule.FAULTS`; any at a strength of zero.
        strength
            As there.
        count
            Frames; of hidden holes they share the holes.
        names
            Of what is drawn.

        Raises
        ------
        ValueError
            For another fault.
        """
        scene, pattern = self.scene(count, *names), self._pattern
        named = ("learned", *self.preset.streams, self.preset.unit, *names)
        seen = scene
        if strength > 0.0:
            if fault == "laser":
                seen = self._beside(scene, strength, *names)
            elif fault == "hidden holes":
                passed = pattern["transmission"]
                hidden = generator(*named, "hidden").random(len(passed)) < strength
                pattern = {**pattern, "transmission": np.where(hidden, 0.0, passed)}
            elif fault == "glare":
                drawn = generator(*named, "glare").exponential(size=(count, _POINTS, _POINTS))
                seen = replace(scene, albedo=strength * drawn)
            else:
                raise ValueError(f"no fault {fault!r}")
        read = self.sensor.observe(seen, pattern, NoiseStreams.named(*named, "noise"))
        return Frames(self.correct(read, scene.origin_px), scene.origin_px, scene.sun)

    def _beside(self, scene: Scene, suns: float, *names: str | int) -> Scene:
        """Return the scene with a laser from directions drawn as Suns are."""
        beam: Floats = self.scene(len(scene), *names, "laser").sun
        lit: Any = with_laser(self.sensor, scene, self._pattern, beam, suns)
        return replace(scene, albedo=lit.albedo)
