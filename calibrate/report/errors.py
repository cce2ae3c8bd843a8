"""Errors of a calibration in numbers: of samples left out, by axis and by off-axis angle."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats, UnusableDataError
from calibrate.calibration import Calibration
from calibrate.places import hull_of_poses, off_axis_deg
from calibrate.readings import Readings
from calibrate.uncertainty import NORMAL_95, tangent_offsets

#: Share of a normal variable within three standard deviations.
THREE_SIGMA = 0.9973
_BAND_DEG = 10.0
_AZIMUTHS = 8
#: Largest error of an axis that was not measured, of rounding.
_ROUNDING_DEG = 1e-9


@dataclass(frozen=True)
class Errors:
    """Samples with the errors they had when they were left out."""

    readings: Readings
    offsets: Floats  # (M, 3), predicted minus true; NaN where not answered or tested
    errors_deg: Floats  # (M,), angle between both; NaN where not tested
    sigma_deg: Floats  # (M, 2), stated 1-sigma of two tangent axes

    @classmethod
    def of(cls, found: Calibration) -> Errors:
        """Return those of the chosen model, each sample by a fit without its run or block."""
        offsets = found.chosen.offsets if found.left_out is None else found.left_out
        count = len(found.readings) if offsets is None else len(offsets)
        used = found.readings.thinned(count)
        if offsets is None:
            offsets = np.full((len(used), 3), np.nan)
        errors = separation_deg(used.sun + offsets, used.sun)
        sigma = found.deviations_deg(used.features, dict(used.context))
        return cls(used, offsets, errors, sigma)

    @cached_property
    def known(self) -> NDArray[np.bool_]:
        """Samples (M,) that were tested."""
        return np.isfinite(self.errors_deg)

    @cached_property
    def along_deg(self) -> Floats:
        """Errors (M, 2) along both tangent axes that `sigma_deg` is of, degrees."""
        return tangent_offsets(self.offsets, self.readings.sun)

    @cached_property
    def off_axis_deg(self) -> Floats:
        """Angle (M,) of each true direction from the boresight."""
        return off_axis_deg(self.readings.sun)

    @cached_property
    def covered(self) -> NDArray[np.bool_]:
        """Which errors (M, 2), (M, 1) of one axis, lie within their axis' 95 % interval."""
        inside = np.abs(self.along_deg) <= NORMAL_95 * self.sigma_deg
        measured = (np.abs(self.along_deg[self.known]) > _ROUNDING_DEG).any(axis=0)
        return np.asarray(inside[:, measured] if measured.any() else inside)


@dataclass(frozen=True)
class Row:
    """Errors of some samples; NaN where there are too few to tell."""

    name: str
    samples: int
    mean_deg: float  # of errors with a sign; NaN of angles, which have none
    rms_deg: float
    level95_deg: float  # bound that 95 % stay below
    level3_deg: float  # bound that 99.73 % stay below
    largest_deg: float
    coverage: float = float("nan")  # share within the stated 95 % intervals
    sigma_deg: float = float("nan")  # RMS of the stated 1-sigma


def level(errors: Floats, share: float) -> float:
    """Return the bound that a share of the next errors stays below; NaN for too few errors.

    Examples
    --------
    >>> level(np.arange(1.0, 20.0), 0.95)  # 19 is the fewest
    19.0
    >>> level(np.arange(18.0), 0.95)
    nan
    """
    place = int(np.ceil(share * (len(errors) + 1) - 1e-9))
    return float(np.sort(errors)[place - 1]) if 1 <= place <= len(errors) else float("nan")


def fewest_for(share: float) -> int:
    """Return the number of errors from which `level` tells a share's bound."""
    return int(np.ceil(share / (1.0 - share) - 1e-9))


def by_axis(found: Errors) -> list[Row]:
    """Return errors along x and y, off the boresight and around it."""
    sun, offsets = found.readings.sun[found.known], found.offsets[found.known]
    x, y, z = np.eye(3)
    axes = {"along x": _towards(x, sun), "along y": _towards(y, sun)}
    axes["off-axis angle"] = -_towards(z, sun)
    axes["around the boresight"] = np.cross(sun, -_towards(z, sun))
    rows = []
    for name, axis in axes.items():
        along = np.degrees((offsets * axis).sum(axis=1))
        rows.append(_row(name, along[np.isfinite(along)]))
    return rows


def by_band(found: Errors) -> list[Row]:
    """Return errors and coverage in bands of the off-axis angle, and of all samples last."""
    off, rows = found.off_axis_deg, []
    last = int(np.nanmax(off, initial=0.0) // _BAND_DEG)
    for number in range(last + 1):
        low, high = number * _BAND_DEG, (number + 1) * _BAND_DEG
        band = found.known & (low <= off) & (off < high)
        if band.any():
            rows.append(_of(f"{low:.0f} to {high:.0f} deg", found, band))
    return [*rows, _of("all", found, found.known)]


def by_run(found: Errors) -> list[Row]:
    """Return errors of each run, the largest first; none where there is one run."""
    run, names = found.readings.run, found.readings.run_names
    numbers = np.unique(run)
    if len(numbers) < 2:
        return []
    rows = [_of(f"{n + 1}: {names[n]}", found, found.known & (run == n)) for n in numbers]
    return sorted((row for row in rows if row.samples), key=lambda row: -row.rms_deg)


def by_temperature(found: Errors) -> list[Row]:
    """Return errors in fifths of the temperature; none where it is not known or the same."""
    column = found.readings.context.get("temperature_K")
    if column is None or not np.ptp(column) > 0:
        return []
    edges = np.unique(np.quantile(column, np.linspace(0.0, 1.0, 6)))
    fifth = np.clip(np.searchsorted(edges, column, side="right") - 1, 0, len(edges) - 2)
    rows = [
        _of(f"{low:.1f} to {high:.1f} K", found, found.known & (fifth == at))
        for at, (low, high) in enumerate(pairwise(edges))
    ]
    return [row for row in rows if row.samples]


@dataclass(frozen=True)
class Field:
    """The region that was measured, as angles from the boresight."""

    least_deg: float  # that poses reach in every direction
    most_deg: float  # and in some
    reach: tuple[tuple[float, float], ...]  # azimuth from +x towards +y, off-axis angle there


def field_of(sun: Floats, azimuths: int = _AZIMUTHS) -> Field | None:
    """Return how far the hull of poses (N, 3) reaches; None where the boresight is outside.

    Of poses along one axis, the two ends.
    """
    try:
        hull = hull_of_poses(sun)
    except UnusableDataError:
        return _sweep(sun)
    off = np.arange(0.0, 180.25, 0.25)
    reach = []
    for azimuth in np.arange(azimuths) * 360.0 / azimuths:
        inside = hull.outside(ray(azimuth, off)) <= 1e-9 if len(hull.facets) else off >= 0.0
        if not inside[0]:
            return None
        last = len(off) if inside.all() else int(np.argmin(inside))
        reach.append((float(azimuth), float(off[last - 1])))
    angles = [angle for _, angle in reach]
    return Field(min(angles), max(angles), tuple(reach))


def _sweep(sun: Floats) -> Field | None:
    """Return the ends of poses (N, 3) along one axis; None where the boresight is outside."""
    axis = np.linalg.svd(sun[:, :2], full_matrices=False)[2][0]
    axis = axis if axis.sum() >= 0 else -axis
    off = np.degrees(np.arctan2(sun[:, :2] @ axis, sun[:, 2]))
    low, high = float(off.min()), float(off.max())
    if not low < 0.0 < high:
        return None
    azimuth = float(np.degrees(np.arctan2(axis[1], axis[0])))
    return Field(min(-low, high), max(-low, high), ((azimuth, high), (azimuth + 180.0, -low)))


def ray(azimuth_deg: float | Floats, off_deg: float | Floats) -> Floats:
    """Return unit vectors (N, 3) at azimuths and off-axis angles, degrees."""
    azimuth, off = np.broadcast_arrays(np.radians(azimuth_deg), np.radians(off_deg))
    return np.column_stack(
        [np.sin(off) * np.cos(azimuth), np.sin(off) * np.sin(azimuth), np.cos(off)]
    )


def _towards(axis: Floats, sun: Floats) -> Floats:
    """Return unit vectors (N, 3) square to directions, towards an axis; NaN on the axis."""
    square = axis - (sun @ axis)[:, None] * sun
    length = np.linalg.norm(square, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(length[:, None] > 1e-6, square / length[:, None], np.nan)


def _of(name: str, found: Errors, some: NDArray[np.bool_]) -> Row:
    row = _row(name, found.errors_deg[some], signed=False)
    if not row.samples:
        return row
    sigma = float(np.sqrt(np.mean(found.sigma_deg[some] ** 2)))
    return replace(row, coverage=float(found.covered[some].mean()), sigma_deg=sigma)


def _row(name: str, errors: Floats, *, signed: bool = True) -> Row:
    size = np.abs(errors)
    if not len(size):
        nothing = float("nan")
        return Row(name, 0, nothing, nothing, nothing, nothing, nothing)
    return Row(
        name,
        len(size),
        float(errors.mean()) if signed else float("nan"),
        float(np.sqrt(np.mean(size**2))),
        level(size, 0.95),
        level(size, THREE_SIGMA),
        float(size.max()),
    )
