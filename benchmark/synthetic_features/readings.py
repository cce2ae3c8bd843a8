"""Reference readings of few elements: a quadrant photodiode, and the faces of a cube."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.light import READ_NOISE_E, peak_e, position_bound
from benchmark.synthetic_features.series import Sample, SeriesPoint, noise, pedestals, word

_FACES = (
    *((1.0, 0.0, 0.0), (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    *((0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)),
)
_FRAMES = 300


def _read(mean_e: Floats, peak: float, pedestal: float, rng: np.random.Generator) -> Floats:
    """Return readings in electrons, not rounded: Poisson and read noise, a share of the peak."""
    read = rng.poisson(mean_e) + rng.normal(0.0, READ_NOISE_E, mean_e.shape)
    return np.asarray(read + pedestal * peak)


@dataclass(frozen=True)
class QuadrantSeries:
    """A square spot over four quadrants: readings Q1 to Q4 in the order of alg:VB."""

    name: str = "quadrants"
    observation: Observation = Observation.CURRENTS
    unit: str = "balance"
    description: str = (
        "a square spot over four quadrants, off the middle by up to 0.6 of its half width; the "
        "SNR is that of a quadrant of the spot in the middle, read noise 10 e-"
    )

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point; `range_px` is in units of the spot's half width."""
        base = SeriesPoint("reference", self.name, None, _FRAMES, range_px=0.6)
        return (
            base,
            *noise(base),
            *pedestals(base),
            word("location", "middle", base, range_px=0.1),
            word("location", "anywhere", base, range_px=0.95),
        )

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:  # noqa: ARG002 - the protocol's
        """Return a sensor with one square aperture."""
        return SensorGeometry(
            focal_length_mm=1.0,
            aperture_width_mm=2.0,
            aperture_shape="square",
            half_fov_deg=40.0,
        )

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return readings (N, 4), balances (N, 2) and their bound."""
        peak = peak_e(setting.snr)
        balances = setting.places(self.name)

        def mean(at: Floats) -> Floats:
            x, y = at[:, 0], at[:, 1]
            shares = [(1 - x) * (1 + y), (1 + x) * (1 + y), (1 + x) * (1 - y), (1 - x) * (1 - y)]
            return peak * np.stack(shares, axis=1)

        bound = position_bound(
            mean, balances, lambda here: [here], lambda here: here + READ_NOISE_E**2, 1e-4
        )
        rng = setting.noise(self.name)
        return Sample(_read(mean(balances), peak, setting.pedestal, rng), balances, bound)

    def estimates(self, features: Floats) -> Floats:
        """Return the balances themselves."""
        return features


@dataclass(frozen=True)
class FacesSeries:
    """Six photodiodes on a cube's faces: the truth is the Sun's direction."""

    name: str = "faces"
    observation: Observation = Observation.CURRENTS
    unit: str = "rad"
    description: str = (
        "cosine readings of the six faces of a cube, the Sun anywhere; the SNR is that of a face "
        "at normal incidence, read noise 10 e-; the direction is that of the differences of "
        "opposite faces"
    )

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point."""
        base = SeriesPoint("reference", self.name, None, _FRAMES)
        return (base, *noise(base), *pedestals(base))

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:  # noqa: ARG002 - the protocol's
        """Return the cube."""
        return SensorGeometry(face_normals=_FACES)

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return readings (N, 6), directions (N, 3) and the bound of a tangent axis."""
        peak = peak_e(setting.snr)
        rng = generator("sweep", self.name, setting.sweep, setting.point, "places")
        sun = rng.standard_normal((setting.frames, 3))
        sun /= np.linalg.norm(sun, axis=1, keepdims=True)
        normals = np.array(_FACES)
        first = np.cross(sun, np.eye(3)[np.abs(sun).argmin(axis=1)])
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(sun, first)

        def mean(moved: Floats) -> Floats:
            at = sun + moved[:, :1] * first + moved[:, 1:] * second
            at /= np.linalg.norm(at, axis=1, keepdims=True)
            return np.asarray(peak * np.maximum(at @ normals.T, 0.0))

        # what a face gives when it is dark tells nothing: the derivative there is zero
        bound = position_bound(
            mean,
            np.zeros((setting.frames, 2)),
            lambda here: [here],
            lambda here: here + READ_NOISE_E**2,
            1e-6,
        )
        light = mean(np.zeros((setting.frames, 2)))
        readings = _read(light, peak, setting.pedestal, setting.noise(self.name))
        return Sample(readings, sun, bound)

    def estimates(self, features: Floats) -> Floats:
        """Return unit vectors (N, 3): differences of opposite faces, at length one."""
        sun = features[:, 0::2] - features[:, 1::2]
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.asarray(sun / np.linalg.norm(sun, axis=1, keepdims=True))
