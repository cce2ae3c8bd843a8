"""A kink of the table's angles at their zero: one half of an axis of another scale."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import angles_from_sun
from algorithms.contract import FeatureKind, Floats
from calibrate.conventions.finding import Finding
from calibrate.readings import Readings
from calibrate.robust import degree_for, terms
from calibrate.settings import Settings

_MOST, _FEWEST = 2000, 100
_BLOCKS, _CERTAIN = 8, 6.0
#: Share of what a smooth function leaves that the kink explains, and the least change of slope.
_SHARE = 0.05
_LEAST = 0.01
#: Standard errors by which a kink may seem smaller than it is, 19 times of 20.
_SMALLER = 2.0
#: Medians of what a smooth function leaves beyond which a pose is wrong, and rounds to settle them.
_OFF, _ROUNDS = 6.0, 10


@dataclass(frozen=True)
class _Bend:
    """The change of slope of an axis at zero.

    `of_share` is the change that would explain the least share reported of the variance that a
    smooth function leaves.
    """

    change: float
    error: float  # 1-sigma of it, by a jackknife of blocks
    of_share: float
    spread_deg: float  # of the angles above zero, those below taken for zero

    @property
    def moved_deg(self) -> float:
        """What the kink does to angles."""
        return abs(self.change) * self.spread_deg

    def least(self, noise_deg: float) -> float:
        """Return the change of slope from which a kink is reported."""
        of_noise = 0.5 * noise_deg / self.spread_deg
        return max(_CERTAIN * self.error, _LEAST, of_noise, self.of_share)


def largest_unnoticed(readings: Readings, settings: Settings, noise_deg: float) -> float:
    """Return the largest kink that may go unnoticed, as a share of the slope.

    Zero where it would move angles by less than the noise does, or where no axis has two halves.
    """
    found = [
        size
        for _, bend in _bends(readings, settings)
        if (size := bend.least(noise_deg) + _SMALLER * bend.error) * bend.spread_deg > noise_deg
    ]
    return max(found, default=0.0)


def of_kinks(readings: Readings, settings: Settings, noise_deg: float) -> Iterator[Finding]:
    """Yield axes of the table whose angles bend at zero, as no smooth function of readings does.

    Channels are left out: light that leaves a face bends its signal at the same place.
    """
    for name, bend in _bends(readings, settings):
        if abs(bend.change) > bend.least(noise_deg):
            yield Finding(
                "kink",
                f"angles of {name} above zero seem to be {100 * abs(bend.change):.2g} % "
                f"{'larger' if bend.change > 0 else 'smaller'} than those below, as readings "
                "change with them",
                bend.moved_deg, noise_deg, {}, True,
                "a sensor of which one half responds otherwise looks alike",
            )  # fmt: skip


def _bends(readings: Readings, settings: Settings) -> Iterator[tuple[str, _Bend]]:
    """Yield the change of slope of each axis of the table that has angles on both sides of zero."""
    azimuth = settings.direction.form.startswith("azimuth")
    if azimuth or readings.kind is FeatureKind.SIGNALS or len(readings) < _FEWEST:
        return
    used = readings.thinned(_MOST)
    angles = angles_from_sun(used.sun) if used.angles is None else used.angles
    names = settings.direction.columns if used.angles is not None else ("alpha", "beta")
    for at, name in enumerate(names):
        if (angles[:, at] < 0).any() and (angles[:, at] > 0).any():
            yield name, _bend(used, angles[:, at])


def _bend(readings: Readings, angle: Floats) -> _Bend:
    """Return the change of slope of an angle (N,) at zero.

    Angles are a smooth function of the readings and of the angle above zero.
    """
    features = readings.features
    scaled = (features - features.mean(axis=0)) / np.maximum(features.std(axis=0), 1e-12) / 2.0
    design = terms(scaled, degree_for(len(angle), features.shape[1]))
    tangents = readings.sun[:, :2] / readings.sun[:, 2:]
    along = [abs(float(np.corrcoef(angle, tangents[:, at])[0, 1])) for at in (0, 1)]
    tangent = tangents[:, int(np.argmax(along))]
    # what images tangents is smoother over them than over angles; without its kink
    left, hinge_left, inside = min(
        (_parted(design, form) for form in (angle, tangent)), key=_share_left
    )
    other = tangents[inside, int(np.argmin(along))]
    block = np.argsort(np.argsort(other)) * _BLOCKS // len(other)
    whole = _ratio(hinge_left, left)
    without = np.array([_ratio(hinge_left[block != n], left[block != n]) for n in range(_BLOCKS)])
    scatter = float(np.sum((without - without.mean()) ** 2))
    rest = float(np.var(left - whole * hinge_left))
    of_hinge = max(float(np.var(hinge_left)), 1e-300)
    return _Bend(
        whole,
        float(np.sqrt((_BLOCKS - 1) / _BLOCKS * scatter)),
        float(np.sqrt(_SHARE / (1.0 - _SHARE) * rest / of_hinge)),
        float(np.std(np.maximum(angle, 0.0))),
    )


def _parted(design: Floats, column: Floats) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return what a smooth function leaves of a column and of its hinge, and of which values (N,).

    The first two in standard deviations of the column.
    """
    inside = _smooth(design, column)
    left = _rest(design[inside], column[inside])
    # of the smooth column: errors of the stated one would go with themselves
    hinge_left = _rest(design[inside], np.maximum(column[inside] - left, 0.0))
    spread = float(np.std(column[inside]))
    return left / spread, hinge_left / spread, inside


def _smooth(design: Floats, column: Floats) -> NDArray[np.bool_]:
    """Return which values (N,) a smooth function follows: a wrong pose is off it, and no kink."""
    kept = np.ones(len(column), dtype=np.bool_)
    for _ in range(_ROUNDS):
        fit = np.linalg.lstsq(design[kept], column[kept], rcond=None)[0]
        size = np.abs(column - design @ fit)
        now = size <= _OFF * np.median(size)
        if np.array_equal(now, kept) or now.sum() < 2 * design.shape[1]:
            break
        kept = now
    return kept


def _share_left(parted: tuple[Floats, Floats, NDArray[np.bool_]]) -> float:
    left, hinge_left, _ = parted
    return float(np.var(left - _ratio(hinge_left, left) * hinge_left))


def _rest(design: Floats, column: Floats) -> Floats:
    return np.asarray(column - design @ np.linalg.lstsq(design, column, rcond=None)[0])


def _ratio(hinge: Floats, left: Floats) -> float:
    return float(hinge @ left / max(float(hinge @ hinge), 1e-300))
