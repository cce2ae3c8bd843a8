"""A whole benchmark in small: four tilted diodes, whose bound has a closed form.

Kept importable (not a test module) so that worker processes and digests of code find it;
imports nothing of the benchmark, so that its keys do not change with it.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from algorithms.contract import (
    AboutExtractor,
    AboutModel,
    FeatureKind,
    Observation,
    SensorGeometry,
    UnusableDataError,
)

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
    context: Any = None
    true_sun: Any = None

    @property
    def truth(self) -> Any:
        return self.sun if self.true_sun is None else self.true_sun


@dataclass(frozen=True)
class FakeSetup:
    """A condition without a bench, of a sensor that has no references."""

    bench: Any = None
    sensor: Any = None
    renewed: bool = False
    mission: Any = None

    def referred(self, split: str = "calibration") -> Any:
        return self.sensor


@dataclass(frozen=True)
class FakeBound:
    angle_deg: Any
    observable: Any
    unit_angle_deg: Any = None


@dataclass(frozen=True)
class FakeRepeats:
    """Every twentieth pose of the test split, four times."""

    passes: int = 4

    def pose_indices(self, test_samples: int) -> Any:
        return np.arange(0, test_samples, 20)


@dataclass(frozen=True)
class Diodes:
    """The data set; what a test changes of it is a field.

    `late` is a current added to one diode from the tenth sample on, `looseness` a factor of the
    bound, `unit_share` how many times it is where the unit is not known, `reference_error` that of
    the calibration's directions, `dark` a share of the test samples that no direction can be
    determined of.
    """

    name: str = "fake-diodes"
    version: int = 1
    detector: str = "PD"
    mask: str = "Maskless"
    observation: Observation = Observation.CURRENTS
    conditions: tuple[str, ...] = ("quiet", "noisy")
    context_columns: tuple[str, ...] = ()
    n: int = 400
    seed: int = 7
    late: float = 0.0
    looseness: float = 1.0
    unit_share: float = 1.25
    reference_error: float = 0.0
    dark: float = 0.0
    unit: int = 0
    repeats: FakeRepeats = FakeRepeats()
    offered: None = None

    @property
    def streams(self) -> tuple[str, int]:
        return self.name, self.version

    @property
    def geometry(self) -> SensorGeometry:
        return SensorGeometry(
            face_normals=tuple(tuple(row) for row in NORMALS.tolist()), half_fov_deg=25.0
        )

    def geometry_for(self, condition: str) -> SensorGeometry:
        return self.geometry

    def for_unit(self, number: int) -> Diodes:
        return replace(self, unit=number)

    def noise(self, condition: str) -> float:
        return {"quiet": 1e-3, "nominal": 1e-3, "noisy": 1e-2}[condition]

    def parameters(self, condition: str) -> dict[str, Any]:
        return {
            "version": self.version,
            "noise": self.noise(condition),
            "n": self.n,
            "seed": self.seed,
            "late": self.late,
            "looseness": self.looseness,
            "dark": self.dark,
            "unit": self.unit,
        }

    def truth(self, condition: str, split: str) -> Any:
        if split == "repeat":
            test = self.truth(condition, "test")
            return np.tile(test[self.repeats.pose_indices(self.n)], (self.repeats.passes, 1))
        rng = np.random.default_rng([self.seed, *f"{self.name} {condition} {split}".encode()])
        off = np.deg2rad(25.0) * np.sqrt(rng.random(self.n))
        around = 2 * np.pi * rng.random(self.n)
        return np.stack(
            [np.sin(off) * np.cos(around), np.sin(off) * np.sin(around), np.cos(off)], axis=1
        )

    def generate(self, condition: str, split: str, n: int | None = None) -> FakeSamples:
        unit, first = f" unit {self.unit}" if self.unit else "", f" first {n}" if n else ""
        log(f"generate {self.name} {condition} {split}{unit}{first}")
        sun = self.truth(condition, split)
        names = f"noise {self.name} {condition} {split} {self.unit}"
        noise = np.random.default_rng([self.seed, *names.encode()]).standard_normal((len(sun), 4))
        gain = np.random.default_rng(self.unit).uniform(-0.01, 0.01, 4) if self.unit else 0.0
        currents = (1.0 + gain) * (sun @ NORMALS.T) + self.noise(condition) * noise
        currents[10:, 0] += self.late
        return FakeSamples(currents[:n], sun[:n])

    def condition(self, name: str) -> FakeSetup:
        return FakeSetup()

    def references(self, condition: str, split: str = "calibration") -> dict[str, Any]:
        return {}

    def reference_error_deg(self, condition: str) -> float:
        return self.reference_error

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> FakeBound:
        """Known amplitude, white noise: covariance of the tangent plane is sigma^2 (J^T J)^-1."""
        log(f"bound {self.name} {condition} {split}")
        sun = self.truth(condition, split)[:n]
        helper = np.where(np.abs(sun[:, :1]) < 0.9, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        first = np.cross(sun, helper)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        tangents = np.stack([first, np.cross(sun, first)], axis=2)
        jacobian = NORMALS @ tangents
        information = np.swapaxes(jacobian, 1, 2) @ jacobian / self.noise(condition) ** 2
        variance = np.trace(np.linalg.inv(information), axis1=1, axis2=2)
        observable = np.arange(len(sun)) >= self.dark * self.n
        angle = self.looseness * np.rad2deg(np.sqrt(variance))
        bound = np.where(observable, angle, np.inf)
        return FakeBound(bound, observable, self.unit_share * bound)


CURRENTS = AboutExtractor(
    name="fake-currents",
    taxonomy="Direct",
    observation=Observation.CURRENTS,
    kind=FeatureKind.SIGNALS,
)


class _Extractor:
    features = ("x_px", "y_px")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls()

    def extract(self, observations: Any) -> Any:
        log(f"extract {self.about.name} {len(observations)}")
        time.sleep(float(os.environ.get("FAKE_ATLAS_SLEEP", "0")))
        return np.asarray(observations, dtype=np.float64).copy()


@dataclass(frozen=True)
class Currents(_Extractor):
    about: ClassVar = CURRENTS
    gain: float = 1.0
    faces: int = 4

    @property
    def features(self) -> tuple[str, ...]:
        return tuple("abcdef"[: self.faces])

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls(faces=len(geometry.face_normals or ()))


@dataclass(frozen=True)
class Gaps(Currents):
    """Finds nothing in every fourth sample."""

    about: ClassVar = replace(CURRENTS, name="fake-gaps")

    def extract(self, observations: Any) -> Any:
        features = super().extract(observations)
        features[::4] = np.nan
        return features


@dataclass(frozen=True)
class Framed(_Extractor):
    about: ClassVar = AboutExtractor(
        name="fake-framed",
        taxonomy="BCM",
        observation=Observation.FRAMES,
        kind=FeatureKind.SPOT,
    )


@dataclass(frozen=True)
class Balanced(_Extractor):
    about: ClassVar = AboutExtractor(
        name="fake-balanced",
        taxonomy="Voltage balance",
        needs=("aperture_width_mm",),
        observation=Observation.CURRENTS,
        kind=FeatureKind.BALANCE,
    )
    features = ("s_a", "s_b")

    def extract(self, observations: Any) -> Any:
        q1, q2, q3, q4 = super().extract(observations).T
        both = np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4])
        return both / observations.sum(axis=1, keepdims=True)


@dataclass
class LeastSquares:
    about: ClassVar = AboutModel(
        name="fake-least-squares",
        taxonomy="LSQ",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )
    normals: tuple[tuple[float, ...], ...] = ()
    matrix_: Any = field(default=None, init=False)

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        return cls(normals=geometry.face_normals or ())

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        self.matrix_ = np.linalg.pinv(np.array(self.normals)).T
        return self

    def predict(self, features: Any, context: Any = None) -> Any:
        vectors = np.asarray(features) @ self.matrix_
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@dataclass
class Broken(LeastSquares):
    about: ClassVar = replace(LeastSquares.about, name="fake-broken")

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        log("fit fake-broken")
        if not os.environ.get("FAKE_ATLAS_MENDED"):
            raise RuntimeError("gives up\nalways")
        return super().fit(features, sun, context)


@dataclass
class Unbuildable(LeastSquares):
    about: ClassVar = replace(LeastSquares.about, name="fake-unbuildable")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        raise RuntimeError("no such sensor")


@dataclass
class Choosy(LeastSquares):
    """Cannot work on any data, and says so in its contract's words."""

    about: ClassVar = replace(LeastSquares.about, name="fake-choosy")

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        log("fit fake-choosy")
        raise UnusableDataError("needs other samples")


@dataclass
class Singular(LeastSquares):
    """Its linear algebra gives up: a ValueError like a refusal, and none."""

    about: ClassVar = replace(LeastSquares.about, name="fake-singular")

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        log("fit fake-singular")
        np.linalg.inv(np.zeros((2, 2)))
