"""Frames of simulated units, to train on and to try: drawn, lit, read and corrected.

Suns are drawn as those of a data set's test are; everything is drawn anew by names of its own, so
that no frame here is one that is scored.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from algorithms.contract import Floats
from benchmark.datasets.corrected import correction
from benchmark.datasets.preset import Preset
from benchmark.seeds import generator
from benchmark.simulator.readout.noise import NoiseStreams
from benchmark.simulator.scene import Scene
from benchmark.spoofing.second_light import with_laser

#: Units that train, and units that settings are chosen on; scores are of units below 10.
TRAINING, VALIDATION = range(20, 28), range(40, 43)
#: Frames that are simulated together.
_TOGETHER = 64


@dataclass(frozen=True)
class Frames:
    """Corrected frames (N, R, C), their first pixels (N, 2) or None, and true Suns (N, 3)."""

    corrected: Floats
    origin_px: Any
    sun: Floats


@dataclass(frozen=True)
class Unit:
    """One unit of a data set under a condition, the first one by default."""

    preset: Preset
    condition: str = ""

    @property
    def _condition(self) -> str:
        return self.condition or self.preset.conditions[0]

    @cached_property
    def sensor(self) -> Any:
        """As it is tested."""
        return self.preset.sensor_for(self._condition, "test")

    @cached_property
    def _pattern(self) -> Any:
        return self.preset.fixed_pattern(self._condition)

    @cached_property
    def _correction(self) -> Any:
        return correction(self.preset, self._condition)

    def correct(self, observations: Any, origin_px: Any) -> Floats:
        """Frames as methods get them: corrected by the unit's own dark and flat readings."""
        by = self._correction
        if by is None:
            return np.asarray(observations, dtype=np.float64)
        found = by.correct(observations, origin_px if by.dark.ndim == 2 else None)
        return np.asarray(found, dtype=np.float64)

    def spot_px(self, sun: Floats) -> Floats:
        """(N, 2) where the image of the Sun's centre truly falls on the detector."""
        sensor = self.sensor
        if hasattr(sensor, "spot_px"):
            return np.asarray(sensor.spot_px(sun))
        return np.asarray(sensor.camera.image_px(sun))

    def scene(self, count: int, *names: str | int) -> Scene:
        """Return Suns and lights drawn as the test's are; windows around the Suns."""
        named = ("learned", *self.preset.streams, self.preset.unit, *names)
        field: Any = replace(self.preset.directions, test_samples=count)  # type: ignore[type-var]
        sun = np.asarray(field.sun("test", generator(*named, "sun")))
        light = self.preset.condition(self._condition).irradiance
        irradiance, stray = light.draw(count, generator(*named, "irradiance"))
        return Scene(sun, irradiance, stray, self.sensor.origins(sun, generator(*named, "window")))

    def taken(self, scene: Scene, *names: str | int, second: Floats | None = None) -> Frames:
        """Read a scene, with second Suns from (N, 3) if given, and correct it."""
        named = ("learned", *self.preset.streams, self.preset.unit, *names, "noise")
        streams, found = NoiseStreams.named(*named), []
        for start in range(0, len(scene), _TOGETHER):
            seen = part = scene.part(start, start + _TOGETHER)
            if second is not None:
                by = second[start : start + _TOGETHER]
                seen = with_laser(self.sensor, part, self._pattern, by, 1.0)
            read = self.sensor.observe(seen, self._pattern, streams)
            found.append(self.correct(read, part.origin_px).astype(np.float32))
        return Frames(np.concatenate(found), scene.origin_px, scene.sun)

    def placed(self, scene: Scene, *names: str | int) -> Floats:
        """(N, 3) Suns whose images are drawn evenly over the windows of a scene."""
        named = ("learned", *self.preset.streams, self.preset.unit, *names, "place")
        detector, size = self.sensor.detector, np.array(self.sensor.window_px, dtype=np.float64)
        first = np.asarray(scene.origin_px, dtype=np.float64)
        place = first - 0.5 + generator(*named).random((len(scene), 2)) * size
        tangents = (place - np.asarray(detector.centre_px)) * detector.pitch_mm
        height: float = self.sensor.camera.focal_length_mm
        ahead = np.column_stack([tangents / height, np.ones(len(scene))])
        return np.asarray(ahead / np.linalg.norm(ahead, axis=1, keepdims=True))
