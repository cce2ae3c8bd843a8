"""A sensor whose learning curve has a closed form: three lines fitted to noisy directions.

A reading (1, x, y) of places uniform in a square; the Sun stands at ``(x, y, 1)``, made a unit
vector, in a small field, where angles are lengths. Readings of the calibration have errors of
`NOISE` a tangent axis, far less than the field, those of the test errors of `SHAKE`: least squares
of p = 3 parameters an axis errs by ``2 SHAKE^2 + 2 NOISE^2 p / K`` in the mean square after K
poses.
What the calibration says of directions is wrong by far more, and may not be used.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from fake_atlas import CURRENTS, FakeBound, FakeSamples, FakeSetup

from algorithms.contract import (
    AboutModel,
    FeatureKind,
    Observation,
    SensorGeometry,
    UnusableDataError,
)

NOISE, SHAKE, HALF = 3e-4, 1e-4, 0.02
PARAMETERS = 3


def mean_square(poses: Any) -> Any:
    """Expected squared error after so many poses, degrees squared."""
    excess = 2.0 * NOISE**2 * PARAMETERS / np.asarray(poses, dtype=np.float64)
    return np.rad2deg(1.0) ** 2 * (2.0 * SHAKE**2 + excess)


@dataclass(frozen=True)
class Plane:
    """The data set."""

    name: str = "fake-plane"
    version: int = 1
    detector: str = "PD"
    mask: str = "Maskless"
    observation: Observation = Observation.CURRENTS
    conditions: tuple[str, ...] = ("nominal",)
    context_columns: tuple[str, ...] = ()
    poses: int = 400
    unit: int = 0
    offered: None = None

    @property
    def streams(self) -> tuple[str, int]:
        return self.name, self.version

    @property
    def geometry(self) -> SensorGeometry:
        return SensorGeometry(
            face_normals=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), half_fov_deg=2.0
        )

    def geometry_for(self, condition: str) -> SensorGeometry:
        return self.geometry

    def for_unit(self, number: int) -> Plane:
        return replace(self, unit=number)

    def parameters(self, condition: str) -> dict[str, Any]:
        return {"version": self.version, "poses": self.poses, "unit": self.unit}

    def condition(self, name: str) -> Any:
        return FakeSetup()

    def references(self, condition: str, split: str = "calibration") -> dict[str, Any]:
        return {}

    def generate(self, condition: str, split: str, n: int | None = None) -> FakeSamples:
        rng = np.random.default_rng([*f"{self.name} {split} {self.unit}".encode()])
        count = self.poses if split == "calibration" else 2000
        place = rng.uniform(-HALF, HALF, (count, 2))
        off = rng.standard_normal((count, 2))
        test = split != "calibration"
        read = np.column_stack([np.ones(count), place + (SHAKE if test else NOISE) * off])
        sun = np.column_stack([place, np.ones(count)])
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        said = sun if test else np.roll(sun, 1, axis=0)
        context = None
        if self.context_columns:
            context = {name: np.arange(count, dtype=float) for name in self.context_columns}
        return FakeSamples(read[:n], said[:n], None, context, sun[:n])

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> FakeBound:
        angle = np.full(2000, np.rad2deg(np.sqrt(2.0) * SHAKE))[:n]
        return FakeBound(angle, np.ones(len(angle), dtype=bool))


@dataclass(frozen=True)
class Readings:
    about: ClassVar = replace(CURRENTS, name="fake-readings")
    features = ("one", "x", "y")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry) -> Any:
        return cls()

    def extract(self, observations: Any) -> Any:
        return np.asarray(observations, dtype=np.float64).copy()


@dataclass
class Lines:
    """Least squares; refuses less than six poses."""

    about: ClassVar = AboutModel(
        name="fake-lines",
        taxonomy="LSQ",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Any:
        return cls()

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        if len(features) < 6:
            raise UnusableDataError(f"fake-lines needs 6 poses; got {len(features)}")
        if context is not None and not all((np.diff(c) == 1.0).all() for c in context.values()):
            raise ValueError("poses in flight must follow one another")
        wanted = np.asarray(sun)[:, :2] / np.asarray(sun)[:, 2:]
        self.slopes_ = np.linalg.lstsq(np.asarray(features), wanted, rcond=None)[0]
        return self

    def predict(self, features: Any, context: Any = None) -> Any:
        vectors = np.column_stack([np.asarray(features) @ self.slopes_, np.ones(len(features))])
        return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


@dataclass
class Guess(Lines):
    """The same, and answers the right half of the field only."""

    about: ClassVar = replace(Lines.about, name="fake-guess")

    def predict(self, features: Any, context: Any = None) -> Any:
        found = super().predict(features)
        found[np.asarray(features)[:, 1] < 0.0] = np.nan
        return found
