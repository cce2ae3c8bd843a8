"""`FullFramePreset`: a dataset of full frames, whose bound looks at the lit pixels only."""

from __future__ import annotations

from dataclasses import dataclass, replace

from benchmark.datasets.conditions.uneven_light import UnevenPreset
from benchmark.metrics.bounds import Bound, cramer_rao
from benchmark.simulator.masks.apertures import Mask
from benchmark.simulator.sensors.lit_pixels import LitPixels
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

#: Samples whose bound is computed together; memory only, the numbers do not depend on it.
BOUND_BATCH = 4
#: Bounds do without light below this share of the brightest spot's peak: a signal of the order of
#: the read noise at most.
BOUND_SKIRT = 2e-3


def for_bound(sensor: MultiSpotSensor) -> MultiSpotSensor:
    """Return the sensor without the skirts of its spots: faster, and next to nothing is lost."""
    return replace(sensor, skirt=BOUND_SKIRT)


def draw_frames(mask: Mask) -> tuple[tuple[float, float, float], ...]:
    """Return a mask's apertures as `SensorGeometry` holds them: x, y and width, mm."""
    return tuple((a.x_mm, a.y_mm, a.width_mm) for a in mask.apertures)


@dataclass(frozen=True)
class FullFramePreset(UnevenPreset):
    """An `UnevenPreset` whose conditions all hold a `MultiSpotSensor`."""

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> Bound:
        """Cramer-Rao bound of every sample of a split (see `benchmark.metrics.bounds.cramer_rao`).

        Pixels far from light enter as one mean (see `LitPixels`); the sensor is `for_bound`'s.

        Raises
        ------
        TypeError
            When the condition's sensor is no `MultiSpotSensor`.
        """
        light, parts = self.condition(condition).irradiance, []
        for sensor, scene, pattern in self.taken(condition, split, self.scene(condition, split, n)):
            if not isinstance(sensor, MultiSpotSensor):
                raise TypeError(
                    f"{self.name} must hold a MultiSpotSensor; got {type(sensor).__name__}"
                )
            seen = for_bound(sensor)
            for start in range(0, len(scene), BOUND_BATCH):
                part = scene.part(start, start + BOUND_BATCH)
                lit = LitPixels(seen, part, pattern)
                parts.append(
                    cramer_rao(
                        lit, part, pattern, light, self.bound_step_rad, references=self.offered
                    )
                )
        return Bound.join(parts)
