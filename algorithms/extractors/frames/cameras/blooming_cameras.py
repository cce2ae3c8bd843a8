"""The Sun where the blooming lines of several cameras meet (alg:BHT after its transform)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from algorithms.contract import Floats, SensorGeometry
from algorithms.parameters import require_positive
from algorithms.row_arithmetic import normalise

Matrix = tuple[tuple[float, float, float], tuple[float, float, float], tuple[float, float, float]]

_STRAIGHT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
#: Newton steps of the distortion's inverse, and of the intersection's: both settle in five.
_STEPS = 12
#: Sine of the angle between two lines below which they do not determine an intersection.
_PARALLEL = 0.05
#: Half step along a line for its direction, px.
_STEP_PX = 0.5


@dataclass(frozen=True)
class LineCamera:
    """A camera as a line needs it: projection, distortion and attitude.

    Attributes
    ----------
    focal_length_mm, pixel_pitch_mm, centre_px, distortion
        As `SensorGeometry` has them.
    rotation
        Rows of the matrix that turns vectors of the camera's frame into the common one.
    """

    focal_length_mm: float
    pixel_pitch_mm: float
    centre_px: tuple[float, float]
    distortion: tuple[float, float] = (0.0, 0.0)
    rotation: Matrix = _STRAIGHT

    def __post_init__(self) -> None:
        require_positive(
            "LineCamera", focal_length_mm=self.focal_length_mm, pixel_pitch_mm=self.pixel_pitch_mm
        )
        turn = np.asarray(self.rotation, dtype=np.float64)
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-9):
            raise ValueError(f"LineCamera: rotation must be a rotation matrix; got {self.rotation}")

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, rotation: Matrix = _STRAIGHT) -> Self:
        """Return the camera of a design; UnsuitableDesignError without its fields."""
        geometry.require("focal_length_mm", "pixel_pitch_mm", "centre_px", by=cls.__name__)
        return cls(
            geometry.focal_length_mm or 0.0,
            geometry.pixel_pitch_mm or 0.0,
            geometry.centre_px or (0.0, 0.0),
            geometry.lens_distortion or (0.0, 0.0),
            rotation,
        )

    def directions(self, points_px: Floats) -> Floats:
        """Return unit vectors (N, 3) in the common frame of detector points (N, 2), undistorted."""
        k1, k2 = self.distortion
        scale = self.pixel_pitch_mm / self.focal_length_mm
        image = (points_px - np.asarray(self.centre_px)) * scale
        reach = np.linalg.norm(image, axis=1)
        radius = reach.copy()
        with np.errstate(all="ignore"):  # beyond what the lens images: NaN below
            for _ in range(_STEPS):
                square = radius**2
                value = radius * (1.0 + square * (k1 + square * k2)) - reach
                radius = radius - value / (1.0 + square * (3.0 * k1 + 5.0 * k2 * square))
            stretch = 1.0 + radius**2 * (k1 + radius**2 * k2)
            good = np.abs(radius * stretch - reach) <= 1e-9 * (1.0 + reach)
            tangents = np.where(good[:, None], image / stretch[:, None], np.nan)
        head = np.column_stack([tangents, np.ones(len(tangents))])
        return np.asarray(normalise(head) @ np.asarray(self.rotation).T)

    def points_px(self, directions: Floats) -> Floats:
        """Detector points (N, 2) of directions (N, 3) in the common frame; NaN from behind."""
        k1, k2 = self.distortion
        head = directions @ np.asarray(self.rotation)
        front = head[:, 2] > 0.0
        tangents = np.full((len(head), 2), np.nan)
        np.divide(head[:, :2], head[:, 2:], out=tangents, where=front[:, None])
        square = np.sum(tangents**2, axis=1, keepdims=True)
        stretch = 1.0 + square * (k1 + square * k2)
        scale = self.focal_length_mm / self.pixel_pitch_mm
        return np.asarray(np.asarray(self.centre_px) + scale * stretch * tangents)


def sun_from_blooming_lines(lines: Sequence[ArrayLike], cameras: Sequence[LineCamera]) -> Floats:
    """Sun vectors (N, 3) where the blooming lines of several cameras meet.

    A line that is straight on the detector is a curve once the distortion is corrected. For each
    pair of cameras the point that both curves have in common is found by Newton steps along
    their tangents; the Sun is the mean over pairs, weighted by the square of the sine under which
    the two curves meet, times the votes that both have (half their harmonic mean): the inverse
    of the intersection's variance, but for what all share.

    Implements: alg:BHT from the lines on (Liu2016), eq. of ERRATA: weighted mean of pairwise
    intersections after distortion correction.

    Parameters
    ----------
    lines : sequence of array_like, shape (N, 5)
        One array a camera, as `HoughLines.lines` gives them, in detector coordinates; NaN rows
        where a camera saw no line.
    cameras : sequence of LineCamera
        The cameras, in the same order, two or more.

    Returns
    -------
    ndarray, shape (N, 3)
        Unit vectors in the common frame; NaN rows where no two lines meet at an angle.

    Raises
    ------
    ValueError
        On fewer than two cameras, or lines that are not one array (N, 5) a camera.
    """
    given = [np.asarray(line, dtype=np.float64) for line in lines]
    if len(cameras) < 2 or len(given) != len(cameras):
        raise ValueError(
            f"blooming lines meet for two cameras or more, one array of lines each; got "
            f"{len(given)} arrays and {len(cameras)} cameras"
        )
    for line in given:
        if line.ndim != 2 or line.shape != (len(given[0]), 5):
            raise ValueError(
                f"lines must have shape ({len(given[0])}, 5) for each camera; got {line.shape}"
            )
    total = np.zeros((len(given[0]), 3))
    for a, b in combinations(range(len(cameras)), 2):
        sun, sine = _sun_on_line(given[a], cameras[a], given[b], cameras[b])
        votes = given[a][:, 4] * given[b][:, 4] / (given[a][:, 4] + given[b][:, 4])
        met = np.isfinite(sun).all(axis=1) & (sine >= _PARALLEL) & np.isfinite(votes)
        total[met] += (sine**2 * votes)[met, None] * sun[met]
    return normalise(total)


def _sun_on_line(
    line_a: Floats, camera_a: LineCamera, line_b: Floats, camera_b: LineCamera
) -> tuple[Floats, Floats]:
    """Directions (N, 3) that two cameras' lines have in common, and the sine of their angle."""
    with np.errstate(invalid="ignore"):
        at = [0.5 * (line[:, :2] + line[:, 2:4]) for line in (line_a, line_b)]
        along = [normalise(line[:, 2:4] - line[:, :2]) for line in (line_a, line_b)]
    cameras = (camera_a, camera_b)
    sun = np.full((len(line_a), 3), np.nan)
    sine = np.zeros(len(line_a))
    for _ in range(_STEPS):
        normals = []
        for n in range(2):
            before, here, after = (
                cameras[n].directions(at[n] + step * along[n])
                for step in (-_STEP_PX, 0.0, _STEP_PX)
            )
            normals.append(normalise(np.cross(here, after - before)))
        cross = np.cross(normals[0], normals[1])
        sine = np.nan_to_num(np.linalg.norm(cross, axis=1))
        towards = cameras[0].directions(at[0]) + cameras[1].directions(at[1])
        sun = normalise(cross) * np.sign(np.sum(cross * towards, axis=1))[:, None]
        for n in range(2):
            point = cameras[n].points_px(sun)
            at[n] = at[n] + np.sum((point - at[n]) * along[n], axis=1)[:, None] * along[n]
    return sun, sine
