"""Error by the Sun's angle off the boresight: in rings, and over a whole field made of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats

#: A ring with fewer observable samples says nothing.
FEWEST = 5
#: Share of a ring's observable samples that must be answered for it to have an error: a method
#: that is silent at the edge does not have that field.
ANSWERED = 0.95


@dataclass(frozen=True)
class Ring:
    """Directions from `inner_deg` (exclusive but for 0) to `outer_deg` off the boresight."""

    inner_deg: int
    outer_deg: int

    @property
    def column(self) -> str:
        """Name of the ring's error in a row."""
        return f"rms_{self.inner_deg}_{self.outer_deg}_deg"

    @property
    def solid_angle(self) -> float:
        """Share of the whole sphere."""
        inner, outer = (math.cos(math.radians(a)) for a in (self.inner_deg, self.outer_deg))
        return (inner - outer) / 2.0


EDGES_DEG = (0, 10, 20, 30, 40, 50, 60, 70, 90, 180)
RINGS = tuple(Ring(inner, outer) for inner, outer in pairwise(EDGES_DEG))


def ring_errors(sun: Floats, answered: NDArray[np.bool_], error_deg: Floats) -> tuple[float, ...]:
    """Root mean square error of each ring, over its samples with an answer.

    Parameters
    ----------
    sun
        True unit vectors (N, 3) of observable samples.
    answered
        Where (N,) there is an answer.
    error_deg
        Errors (N,); read where there is an answer.

    Returns
    -------
    tuple of float
        One a ring of `RINGS`; NaN with fewer than `FEWEST` samples, or fewer than `ANSWERED` of
        them answered.
    """
    across = np.sqrt(sun[:, 0] ** 2 + sun[:, 1] ** 2)
    off_axis = np.degrees(np.arctan2(across, sun[:, 2]))
    found = []
    for ring in RINGS:
        inside = (off_axis <= ring.outer_deg) & (
            (off_axis > ring.inner_deg) | (ring.inner_deg == 0)
        )
        judged = inside & answered
        enough = inside.sum() >= FEWEST and judged.sum() >= ANSWERED * inside.sum()
        found.append(math.sqrt(float(np.mean(error_deg[judged] ** 2))) if enough else math.nan)
    return tuple(found)


def field_error(row: Mapping[str, object], half_angle_deg: int) -> float | None:
    """Root mean square error over a cone about the boresight, from the rings of a stored row.

    Rings count by their solid angle, however a dataset's samples are spread: sensors are compared
    at an equal field.

    Parameters
    ----------
    row
        With the rings' columns.
    half_angle_deg
        Of the cone; one of `EDGES_DEG` above 0.

    Returns
    -------
    float or None
        None where a ring of the field has no error.

    Raises
    ------
    ValueError
        For an angle that is no ring's edge.
    """
    if half_angle_deg not in EDGES_DEG[1:]:
        edges = ", ".join(map(str, EDGES_DEG[1:]))
        raise ValueError(
            f"half_angle_deg must be a ring's edge, one of {edges}; got {half_angle_deg}"
        )
    total = weight = 0.0
    for ring in RINGS:
        if ring.outer_deg <= half_angle_deg:
            error = row[ring.column]
            if not isinstance(error, float | int):
                return None
            total += ring.solid_angle * error**2
            weight += ring.solid_angle
    return math.sqrt(total / weight)


def widest_field(row: Mapping[str, object], largest_deg: float) -> int | None:
    """Half angle of the widest cone in whose every ring the error stays within `largest_deg`.

    None where the innermost ring already has a larger one, or none.
    """
    widest = None
    for ring in RINGS:
        error = row[ring.column]
        if not isinstance(error, float | int) or error > largest_deg:
            break
        widest = ring.outer_deg
    return widest
