"""stub"""
from __future__ import annotations
from dataclasses import dataclass
from typing import ClassVar, Self
import numpy as np
from numpy.typing import ArrayLike
from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation, SensorGeometry
from algorithms.extractors.frames.matched import require_one_spot
from algorithms.inputs import as_frames

@dataclass(frozen=True)
class MirrorRegistration(Extractor):
    """x."""
    about: ClassVar = AboutExtractor(name="mirror", taxonomy="None", origin="ours", observation=Observation.FRAMES, kind=FeatureKind.SPOT)
    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Self:
        require_one_spot(geometry, cls.about.name)
        return cls()
    def extract(self, observations: ArrayLike) -> Floats:
        from algorithms.extractors.frames import mirror_kernel, mirror_search_kernel
        from algorithms.kernels import moments
        frames = as_frames(observations)
        count = len(frames)
        unusable = np.empty(count, dtype=np.bool_)
        moments.unusable(frames, frames.dtype.kind == "f", unusable)
        lights = np.empty((count, 8))
        mirror_search_kernel.find_lights(frames, unusable, lights)
        found = np.empty((count, 3))
        mirror_kernel.mirror_centres(frames, lights, found)
        self.__dict__['last']=(lights,found)
        return found[:, :2].copy()
