"""A whole benchmark in small: four tilted diodes, whose bound has a closed form.

Kept importable (not a test module) so that worker processes and digests of code find it;
imports nothing of the benchmark, so that its keys do not change with it.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from algorithms.contract import FeatureKind, Observation, SensorGeometry

_TILT = np.deg2rad(30.0)
NORMALS = np.array(
    [
        [np.sin(_TILT), 0.0, np.cos(_TILT)],
        [-np.sin(_TILT), 0.0, np.cos(_TILT)],
        [0.0, np.sin(_TILT), np.cos(_TILT)],
        [0.0, -np.sin(_TILT), np.cos(_TILT)],
    ]
)


def log(line: str) -> None:
    """Append to the file named by FAKE_ATLAS_LOG: what was really done, whoever did it."""
    if path := os.environ.get("FAKE_ATLAS_LOG"):
        with Path(path).open("a") as file:
            file.write(line + "\n")


@dataclass(frozen=True)
class FakeSamples:
    observations: Any
    sun: Any
    origin_px: Any = None


@dataclass(frozen=True)
class FakeBound:
    angle_deg: Any
    observable: Any


@dataclass(frozen=True)
class Diodes:
    name: str = "fake-diodes"
    version: int = 1
    detector: str = "PD"
    mask: str = "Maskless"
    observation: Observation = Observation.CURRENTS
    conditions: tuple[str, ...] = ("quiet", "noisy")
    n: int = 400
    seed: int = 7

    @property
    def geometry(self) -> SensorGeometry:
        return SensorGeometry(
            face_normals=tuple(tuple(row) for row in NORMALS.tolist()), half_fov_deg=25.0
        )

    def geometry_for(self, condition: str) -> SensorGeometry:
        return self.geometry

    def noise(self, condition: str) -> float:
        return {"quiet": 1e-3, "noisy": 1e-2}[condition]

    def parameters(self, condition: str) -> dict[str, Any]:
        return {"noise": self.noise(condition), "n": self.n, "seed": self.seed}

    def truth(self, condition: str, split: str) -> tuple[Any, Any]:
        names = [self.seed, *self.name.encode(), *condition.encode(), *split.encode()]
        rng = np.random.default_rng(names)
        off = np.deg2rad(25.0) * np.sqrt(rng.random(self.n))
        around = 2 * np.pi * rng.random(self.n)
        sun = np.stack(
            [np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)], axis=1
        )
        return sun, rng

    def generate(self, condition: str, split: str) -> FakeSamples:
        log(f"generate {self.name} {condition} {split}")
        sun, rng = self.truth(condition, split)
        currents = sun @ NORMALS.T
        return FakeSamples(
            currents + self.noise(condition) * rng.standard_normal(currents.shape), sun
        )

    def bound(self, condition: str, split: str = "test") -> FakeBound:
        """Known amplitude, white noise: covariance of the tangent plane is sigma^2 (J^T J)^-1."""
        sun, _ = self.truth(condition, split)
        helper = np.where(np.abs(sun[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        first = np.cross(sun, helper)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        tangents = np.stack([first, np.cross(sun, first)], axis=2)
        jacobian = NORMALS @ tangents
        information = np.swapaxes(jacobian, 1, 2) @ jacobian / self.noise(condition) ** 2
        variance = np.trace(np.linalg.inv(information), axis1=1, axis2=2)
        return FakeBound(np.rad2deg(np.sqrt(variance)), np.ones(self.n, dtype=bool))


class _Extractor:
    studies: ClassVar[tuple[str, ...]] = ()
    labels: ClassVar[tuple[str, ...]] = ()
    origin: ClassVar[str] = "ours"
    version: ClassVar[int] = 1
    observation: ClassVar[Observation] = Observation.CURRENTS
    kind: ClassVar[FeatureKind] = FeatureKind.SIGNALS
    needs: ClassVar[tuple[str, ...]] = ()
    features = ("a", "b", "c", "d")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls()

    def extract(self, observations: Any) -> Any:
        log(f"extract {self.name} {len(observations)}")
        time.sleep(float(os.environ.get("FAKE_ATLAS_SLEEP", "0")))
        return np.asarray(observations, dtype=np.float64).copy()


@dataclass(frozen=True)
class Currents(_Extractor):
    name: ClassVar[str] = "fake-currents"
    taxonomy: ClassVar[str] = "Direct"
    gain: float = 1.0


@dataclass(frozen=True)
class Gaps(_Extractor):
    """Finds nothing in every fourth sample."""

    name: ClassVar[str] = "fake-gaps"
    taxonomy: ClassVar[str] = "Direct"

    def extract(self, observations: Any) -> Any:
        features = super().extract(observations)
        features[::4] = np.nan
        return features


@dataclass(frozen=True)
class Framed(_Extractor):
    name: ClassVar[str] = "fake-framed"
    taxonomy: ClassVar[str] = "BCM"
    observation: ClassVar[Observation] = Observation.FRAMES
    kind: ClassVar[FeatureKind] = FeatureKind.SPOT


@dataclass(frozen=True)
class Balanced(_Extractor):
    name: ClassVar[str] = "fake-balanced"
    taxonomy: ClassVar[str] = "Voltage balance"
    kind: ClassVar[FeatureKind] = FeatureKind.BALANCE
    needs: ClassVar[tuple[str, ...]] = ("aperture_width_mm",)


@dataclass
class LeastSquares:
    name: ClassVar[str] = "fake-least-squares"
    taxonomy: ClassVar[str] = "LSQ"
    studies: ClassVar[tuple[str, ...]] = ()
    labels: ClassVar[tuple[str, ...]] = ()
    origin: ClassVar[str] = "ours"
    version: ClassVar[int] = 1
    accepts: ClassVar[frozenset[FeatureKind]] = frozenset({FeatureKind.SIGNALS})
    needs: ClassVar[tuple[str, ...]] = ("face_normals",)
    normals: tuple[tuple[float, ...], ...] = ()
    matrix_: Any = field(default=None, init=False)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        return cls(normals=geometry.face_normals or ())

    def fit(self, features: Any, sun: Any) -> Any:
        self.matrix_ = np.linalg.pinv(np.array(self.normals)).T
        return self

    def predict(self, features: Any) -> Any:
        vectors = np.asarray(features) @ self.matrix_
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@dataclass
class Broken(LeastSquares):
    name: ClassVar[str] = "fake-broken"

    def fit(self, features: Any, sun: Any) -> Any:
        log("fit fake-broken")
        if not os.environ.get("FAKE_ATLAS_MENDED"):
            raise RuntimeError("gives up\nalways")
        return super().fit(features, sun)


@dataclass
class Unbuildable(LeastSquares):
    name: ClassVar[str] = "fake-unbuildable"

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        raise RuntimeError("no such sensor")


@dataclass
class Choosy(LeastSquares):
    name: ClassVar[str] = "fake-choosy"

    def fit(self, features: Any, sun: Any) -> Any:
        log("fit fake-choosy")
        raise ValueError("needs other samples")
