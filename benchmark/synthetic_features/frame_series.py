"""`FramesSeries`: the sets of `frame_sets` as a reference series, drawn under one seed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.synthetic_features.frame_sets import FRAME_SETS, FrameSet
from benchmark.synthetic_features.series import Sample, SeriesPoint, word

#: Names the frames that are published; whoever draws others takes a number.
_SEED = "published"
#: Frames of a set, and of those whose frames are larger than 64 px, by their side.
_FRAMES, _FEWER = 300, MappingProxyType({256: 60, 512: 20})
#: What is varied, by group of sets.
_SWEEPS = MappingProxyType(
    {
        "shapes": "shape",
        "sizes": "radius",
        "stray light and lights": "lights",
        "defects, no Sun": "defects",
    }
)
_SETS: Mapping[str, FrameSet] = MappingProxyType({chosen.name: chosen for chosen in FRAME_SETS})
_PITCH_MM = 0.01


@dataclass(frozen=True)
class FramesSeries:
    """Frames of one spot with its shape, size, stray light, other lights and broken pixels.

    As `make bench` draws them under any seed, but for as many frames as tell shares to a third of
    a percent.
    """

    name: str = "frames"
    observation: Observation = Observation.FRAMES
    unit: str = "px"
    description: str = (
        "one spot of half width 8 px and 2000 e- in a frame of 64 x 64 unless the set says "
        "otherwise, background 20 e-, read noise 10 e-, 12 bit; of two equal lights one is the "
        "Sun, and without a Sun every answer is wrong"
    )

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return a point for each set, in their order."""
        return tuple(
            word(
                _SWEEPS[chosen.group],
                chosen.name,
                SeriesPoint("", "", None, _FEWER.get(chosen.size_px, _FRAMES)),
                size_px=chosen.shape.half_px,
            )
            for chosen in FRAME_SETS
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return a sensor whose one round aperture is as wide as the spot at half its light."""
        middle = (_SETS[setting.point].size_px - 1) / 2.0
        return SensorGeometry(
            focal_length_mm=1.0,
            pixel_pitch_mm=_PITCH_MM,
            centre_px=(middle, middle),
            aperture_width_mm=2.0 * setting.size_px * _PITCH_MM,
            aperture_shape="round",
            half_fov_deg=math.degrees(math.atan(middle * _PITCH_MM)),
        )

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return frames (N, H, W), centres (N, 2), NaN where there is no Sun, and their bound."""
        scenes = _SETS[setting.point].draw(_SEED, setting.frames)
        return Sample(scenes.frames, scenes.centres, scenes.bound_px)

    def estimates(self, features: Floats) -> Floats:
        """Return the features: they are centres."""
        return features
