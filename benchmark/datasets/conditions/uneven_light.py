"""`UnevenPreset`: a dataset in some of whose conditions stray light slopes across the detector."""

from __future__ import annotations

from dataclasses import dataclass

from benchmark.datasets.fields import Split
from benchmark.datasets.preset import Preset
from benchmark.datasets.repeats import Rows
from benchmark.seeds import generator
from benchmark.simulator.light.stray_slope import UnevenIrradiance, UnevenScene
from benchmark.simulator.scene import Scene


@dataclass(frozen=True)
class UnevenPreset(Preset):
    """A `Preset` whose conditions may hold an `UnevenIrradiance`.

    The bound takes the slope as known: it holds for every estimator, a little below what is
    possible without that knowledge.
    """

    def __post_init__(self) -> None:
        for name, setup in self.setups.items():
            if isinstance(setup.irradiance, UnevenIrradiance) and not getattr(
                setup.sensor, "sees_slopes", False
            ):
                raise TypeError(
                    f"condition {name!r}: stray light slopes, which {type(setup.sensor).__name__} "
                    "does not see"
                )

    def _scene(self, condition: str, known: Split, rows: Rows = slice(None)) -> Scene:
        """Sun, irradiance, stray light and windows of a split; slopes from their own stream."""
        scene = super()._scene(condition, known, rows)
        irradiance = self.condition(condition).irradiance
        if not isinstance(irradiance, UnevenIrradiance):
            return scene
        stream = generator(*self.streams, known, "stray-slope")
        size = len(self.directions.sun(known, generator(*self.streams, known, "sun")))
        return UnevenScene.of(scene, irradiance.draw_slopes(size, stream)[rows])
