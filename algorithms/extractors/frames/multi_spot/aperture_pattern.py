"""Find a mask's pattern of apertures in a frame: whole spots, and which aperture cast each."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.pattern_memory import found_once
from algorithms.extractors.frames.multi_spot.records import Lattice, Matches, Seen, Views
from algorithms.row_arithmetic import medians

Apertures = tuple[tuple[float, float, float], ...]
"""A row an aperture: x, y from the middle of the mask, and width, px."""

FieldPx = tuple[float, float, float]
"""Where the pattern is for a Sun on the boresight, x and y, and how far it moves from there, px."""

Limits = tuple[float, float, int, FieldPx | None, bool]
"""Of a search: `MaskSpots`' blur, tolerance, faulty lines and field, and whether frames follow."""

#: Pixels of a spot above its threshold, over those of its aperture: the least of the smallest,
#: the most of the largest with the Sun's image, which grows with incidence.
_AREAS = (0.4, 6.0)
#: Least pixels of a spot: fewer are hot pixels.
_LEAST_PIXELS = 4.0
#: Displacements compared by what the frame shows of every aperture, those that match most spots.
_COMPARED = 24
#: Spots kept of a frame that its edge cuts.
_CUTS = 64
#: Least share of the expected spots.
SHARE = 0.3
#: Pixels of a frame whose median is its background.
_SAMPLE = 4096
#: Least height of spots above the background, in its noise: what small frames of noise do not
#: reach. Large ones do, but their lit pixels make no spots.
_LEAST_SIGNAL = 5.0
#: Spots kept of a frame, an aperture: stray lights may add to them.
_SPOTS_PER_APERTURE = 4


@dataclass(frozen=True, eq=False)
class Levels:
    """Gray levels of frames (N, H, W).

    Attributes
    ----------
    maxima
        (N, H) largest value of each row, in the frames' type.
    floor, peak
        (N,) background, and brightness of the spots.
    threshold
        (N,) level above which a pixel is lit; infinite for a frame that cannot be used.
    """

    maxima: NDArray[Any]
    floor: Floats
    peak: Floats
    threshold: Floats

    def part(self, start: int, end: int | None = None) -> Levels:
        """Levels of the frames ``start .. end - 1``."""
        rows = slice(start, end)
        return Levels(self.maxima[rows], self.floor[rows], self.peak[rows], self.threshold[rows])


class Pattern(NamedTuple):
    """What was found in frames (N, H, W) of a mask of A apertures.

    Attributes
    ----------
    displacement
        (N, 2) of the mask's middle on the detector; NaN where the pattern was not found.
    spots
        (N, A, 2) position of each aperture's spot; NaN where it is not seen whole.
    ambiguous
        (N,) whether another displacement explains the frame nearly as well: that is why there is
        none, or, where there is one, `faulty_lines` lines seen twice in full light would be why.
    """

    displacement: Floats
    spots: Floats
    ambiguous: NDArray[np.bool_]


def nearest_distance(apertures: Floats) -> float:
    """Least distance of two apertures (A, 3); infinite for one alone."""
    if len(apertures) == 1:
        return math.inf
    order = np.lexsort(apertures.T[1::-1])
    x, y = apertures[order, 0], apertures[order, 1]
    least = math.inf
    for step in range(1, len(x)):
        apart = x[step:] - x[:-step]
        if apart.min() >= least:  # sorted by x: those further on are no nearer
            break
        least = min(least, float(np.hypot(apart, y[step:] - y[:-step]).min()))
    return least


@lru_cache(maxsize=8)
def lattice(apertures_px: Apertures) -> Lattice:
    """Return the apertures sorted into cells so small that none holds two."""
    apertures = np.array(apertures_px, dtype=np.float64)
    corner = apertures[:, :2].min(axis=0)
    span = apertures[:, :2].max(axis=0) - corner
    cell = 0.7 * min(nearest_distance(apertures), float(span.max()) + 1.0)
    j, i = np.floor((apertures[:, :2] - corner) / cell).astype(np.int64).T
    table = np.full((i.max() + 1, j.max() + 1), -1, dtype=np.int64)
    table[i, j] = np.arange(len(apertures))
    nearest = nearest_distance(apertures)
    lines = np.stack([_lines(apertures[:, axis], nearest / 4.0) for axis in (0, 1)])
    for array in (apertures, table, corner, lines):
        array.flags.writeable = False
    return Lattice(apertures, table, corner, cell, nearest, lines)


def _lines(coordinates: Floats, apart: float) -> NDArray[np.int64]:
    """Give the line that each coordinate (A,) is on: a step of more than `apart` begins one."""
    order = np.argsort(coordinates, kind="stable")
    lines = np.empty(len(coordinates), dtype=np.int64)
    lines[order] = np.concatenate([[0], np.cumsum(np.diff(coordinates[order]) > apart)])
    return lines


def frame_levels(frames: NDArray[Any], apertures_px: Apertures, threshold: float) -> Levels:
    """Levels of the frames (N, H, W) of `as_frames`, each by itself.

    The floor is the median of some of the pixels. The peak is not the frame's brightest pixel,
    which may be a hot one, but the value that half as many rows exceed as an aperture is wide.
    """
    from algorithms.kernels import moments  # noqa: PLC0415 - Numba, at the first frame only

    count, height, _ = frames.shape
    maxima = np.empty((count, height), dtype=frames.dtype)
    moments.row_maxima(frames, maxima)
    unusable = moments.unusable_frames(frames)
    maxima[unusable] = 0
    floor, noise = _floor_and_noise(frames)
    narrowest = min(width for _, _, width in apertures_px)
    rank = height - min(max(round(narrowest / 2.0), 1), height)
    peak = np.partition(maxima, rank, axis=1)[:, rank].astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):  # infinite pixels: unusable
        unusable |= ~((peak > floor) & (peak - floor >= _LEAST_SIGNAL * noise))
        level = floor + threshold * (peak - floor)
    level[unusable] = np.inf
    return Levels(maxima, floor, peak, level)


def find_pattern(
    frames: NDArray[Any], levels: Levels, apertures_px: Apertures, limits: Limits
) -> Pattern:
    """Find the pattern in each of the frames (N, H, W) of `as_frames`.

    The spots are centroids of the light above the threshold. Each frame is read by itself; in a
    sequence, one that leaves several displacements open has that which is within a quarter of
    the least distance of two apertures from the frame before's. Not to be written to: it may be
    another method's too (`pattern_memory.shared_patterns`).
    """
    return found_once(
        frames,
        (apertures_px, limits, levels.threshold.tobytes()),
        lambda: _find_pattern(frames, levels, apertures_px, limits),
    )


def _find_pattern(
    frames: NDArray[Any],
    levels: Levels,
    apertures_px: Apertures,
    limits: Limits,
) -> Pattern:
    """`find_pattern` without remembering."""
    from algorithms.extractors.frames.multi_spot import (  # noqa: PLC0415 - Numba on first use
        aperture_grid_kernel,
        evidence_kernel,
        spots_kernel,
        view_kernel,
    )

    blur_px, tolerance_px, faulty_lines, field_px, sequence = limits
    count, height, width = frames.shape
    known = lattice(apertures_px)
    widths = known.apertures[:, 2]
    least = max(_AREAS[0] * math.pi / 4.0 * float(widths.min()) ** 2, _LEAST_PIXELS)
    most = max(_AREAS[1] * (float(widths.max()) + blur_px) ** 2, 2.0 * least)
    room = min(_SPOTS_PER_APERTURE * len(widths) + 16, int(height * width / least) + 1)
    seen = room_for_spots(count, room, _CUTS)
    spots_kernel.segment(frames, levels.maxima, levels.threshold, least, most, seen)
    shape = count, _COMPARED, len(widths)
    matches = Matches(
        np.empty((count, _COMPARED, 2)),
        np.empty(shape, dtype=np.int32),
        np.empty(count, dtype=np.int64),
    )
    # for an uncertain answer, a line of spots unexplained is a fault, and some are missing
    slack = (faulty_lines + 0.5) * max(int(np.bincount(line).max()) for line in known.lines) + 4
    aperture_grid_kernel.match(seen, known, (height, width), tolerance_px, slack, matches)
    views = Views(
        np.empty(shape, dtype=np.int8),
        np.empty((count, _COMPARED, _CUTS), dtype=np.int32),
        np.empty((count, room), dtype=np.bool_),
        np.empty((count, _COMPARED), dtype=np.bool_),
    )
    margin = margin_px(blur_px)
    view_kernel.look(frames, levels.threshold, seen, known.apertures, margin, SHARE, matches, views)
    displacement = np.empty((count, 2))
    partners = np.empty((count, len(widths)), dtype=np.int64)
    reason = np.empty(count, dtype=np.int64)
    apart = min(known.nearest_px, float(height + width)) / 4.0
    evidence_kernel.decide(
        seen,
        known,
        tolerance_px,
        (float(faulty_lines), apart if sequence else 0.0),
        field_px or (0.0, 0.0, math.inf),
        matches,
        views,
        displacement,
        partners,
        reason,
    )
    positions = np.take_along_axis(seen.spots, np.maximum(partners, 0)[:, :, None], axis=1)[
        :, :, :2
    ]
    positions[partners < 0] = np.nan
    return Pattern(displacement, positions, reason >= evidence_kernel.SEVERAL)


def room_for_spots(count: int, room: int, cuts: int) -> Seen:
    """Room for the spots of so many frames: whole ones and cut ones of each."""
    return Seen(
        np.zeros((count, room, 4)),
        np.empty(count, dtype=np.int64),
        np.zeros((count, cuts, 3)),
        np.empty(count, dtype=np.int64),
    )


def margin_px(blur_px: float) -> float:
    """How far a spot reaches beyond its aperture: half the Sun's image, and a pixel cut."""
    return blur_px / 2.0 + 1.0


def _floor_and_noise(frames: NDArray[Any]) -> tuple[Floats, Floats]:
    """Median (N,) of some of the pixels, and their standard deviation (N,) to the dark side.

    Spots that cover less than half raise neither.
    """
    pixels = frames.reshape(len(frames), -1)
    step = max(pixels.shape[1] // _SAMPLE, 1)
    step += 1 - step % 2
    while math.gcd(step, frames.shape[2]) > 1:  # so that it meets every column
        step += 2
    sample = pixels[:, ::step]
    if sample.dtype.kind == "f":
        sample = sample.astype(np.float64)
    with np.errstate(invalid="ignore", over="ignore"):
        # selecting among short integers takes a fraction of the time
        floor = medians(sample)
        darker = np.minimum(sample - floor[:, None], 0.0)
        noise = np.sqrt(2.0 * np.mean(darker * darker, axis=1))
    return floor, np.asarray(noise, dtype=np.float64)
