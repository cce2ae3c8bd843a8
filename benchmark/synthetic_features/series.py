"""What a reference series is: settings of one scene, drawn observations with truth and bound.

A series is a feature whose light is known in closed form. Sweeps move one setting at a time away
from the reference setting; at every point the same frames are given to every method.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats, Observation, SensorGeometry
from benchmark.seeds import generator
from benchmark.synthetic_features.light import Profile

#: Peak signal over noise of the noise sweep, and of the reference setting of most series.
SNRS = (5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0)
REFERENCE_SNR = 50.0
PHASES = tuple(k / 8.0 for k in range(8))
PEDESTALS = (0.0, 0.5)
MISSING = (0.0, 0.2)
#: Distance from the truth within which a tracked feature counts as kept.
KEPT_PX = 3.0
#: An answer further off is wrong.
WRONG_PX = 1.0
#: Height of the glint in a tracking sequence, in units of the feature.
GLINT = 1.5


@dataclass(frozen=True)
class SeriesPoint:
    """One point of a series; a field that a series does not have stays as it is.

    Attributes
    ----------
    sweep, point
        Names of the sweep and of the point in it.
    value
        Where the point lies on the sweep's axis; None where it is a word.
    frames
        Number of samples.
    snr
        Peak signal over noise.
    size_px
        Radius of a disc, half width of a bar, sigma of a Gaussian.
    range_px
        Largest distance of the feature from the middle along either axis.
    phase_px
        Sub-pixel place of every sample; None leaves it to chance.
    pedestal
        Share of the peak added to every reading.
    features
        Number of features (of a grid: along either axis).
    missing
        Share of features, or of a single feature's pixels, that give no light.
    profile
        Of the light across a feature.
    tracking
        A drifting feature and, from the second frame on, a brighter glint elsewhere.
    """

    sweep: str
    point: str
    value: float | None
    frames: int
    snr: float = REFERENCE_SNR
    size_px: float = 0.0
    range_px: float = 0.0
    phase_px: float | None = None
    pedestal: float = 0.0
    features: int = 1
    missing: float = 0.0
    profile: Profile = "flat"
    tracking: bool = False

    def places(self, *names: str) -> Floats:
        """(frames, 2) displacements from the middle, px; a circle for a drifting feature."""
        if self.tracking:
            # 1.5 px a frame
            turn = 1.5 / self.range_px * np.arange(self.frames)
            return self.range_px * np.column_stack([np.cos(turn), np.sin(turn)])
        rng = generator("sweep", *names, self.sweep, self.point, "places")
        if self.phase_px is not None:
            whole = rng.integers(-2, 3, (self.frames, 2))
            return np.asarray(whole + self.phase_px, dtype=np.float64)
        return rng.uniform(-self.range_px, self.range_px, (self.frames, 2))

    def noise(self, *names: str) -> np.random.Generator:
        """Return the stream of the noise."""
        return generator("sweep", *names, self.sweep, self.point, "noise")


@dataclass(frozen=True)
class Sample:
    """Observations (N, ...) with their truth (N, K), NaN where there is none, and its bound.

    `bound` is the root mean square of one coordinate's Cramer-Rao bound; NaN where the setting
    has no meaningful one.
    """

    observations: NDArray[Any]
    truth: Floats
    bound: float


class Series(Protocol):
    """A feature in closed form."""

    @property
    def name(self) -> str:
        """Unique name."""
        ...

    @property
    def observation(self) -> Observation:
        """What an extractor reads here."""
        ...

    @property
    def unit(self) -> str:
        """Of truth and error."""
        ...

    @property
    def description(self) -> str:
        """What it is, in one sentence."""
        ...

    def settings(self) -> tuple[SeriesPoint, ...]:
        """Return every point of every sweep."""
        ...

    def geometry(self, setting: SeriesPoint) -> SensorGeometry:
        """Return the design a method is built for."""
        ...

    def draw(self, setting: SeriesPoint) -> Sample:
        """Return the observations of a point, always the same."""
        ...

    def estimates(self, features: Floats) -> Floats:
        """Return what extracted features (N, F) say of the truth (N, K)."""
        ...


Word = Literal["reference", "noise", "size", "phase", "pedestal", "profile", "location"]

#: What each sweep's axis is.
SWEEPS: Mapping[str, str] = {
    "reference": "reference setting",
    "noise": "peak SNR",
    "size": "feature size (px)",
    "phase": "sub-pixel phase (px)",
    "pedestal": "pedestal over peak",
    "profile": "profile of the light",
    "location": "place on the detector",
    "missing": "share missing",
    "features": "number of features",
    "tracking": "drifting feature and a glint",
    "shape": "shape of the spot",
    "radius": "radius of a disc",
    "lights": "stray light, ghosts, two lights, the frame's edge",
    "defects": "broken pixels, no Sun",
}


def number(sweep: str, value: float, base: SeriesPoint, **changes: Any) -> SeriesPoint:
    """Return a point of a sweep whose axis is a number."""
    return replace(base, sweep=sweep, point=f"{value:g}", value=float(value), **changes)


def word(sweep: str, point: str, base: SeriesPoint, **changes: Any) -> SeriesPoint:
    """Return a point of a sweep whose axis is a word."""
    return replace(base, sweep=sweep, point=point, value=None, **changes)


def noise(base: SeriesPoint) -> tuple[SeriesPoint, ...]:
    """Return the noise sweep."""
    return tuple(number("noise", snr, base, snr=snr) for snr in SNRS)


def phases(base: SeriesPoint) -> tuple[SeriesPoint, ...]:
    """Return the sub-pixel phase sweep."""
    return tuple(number("phase", phase, base, phase_px=phase) for phase in PHASES)


def pedestals(base: SeriesPoint) -> tuple[SeriesPoint, ...]:
    """Return the readings with and without a pedestal."""
    return tuple(number("pedestal", share, base, pedestal=share) for share in PEDESTALS)


def missing_features(base: SeriesPoint) -> tuple[SeriesPoint, ...]:
    """Return all features, and four of five."""
    return tuple(number("missing", share, base, missing=share) for share in MISSING)


def locations(
    base: SeriesPoint, anywhere_px: float, middle_px: float = 2.0
) -> tuple[SeriesPoint, ...]:
    """Return the feature near the middle, and anywhere."""
    return (
        word("location", "middle", base, range_px=middle_px),
        word("location", "anywhere", base, range_px=anywhere_px),
    )
