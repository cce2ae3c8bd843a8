"""Where the apertures of a built mask are, as spots and the calibration's directions tell together.

`places` compares spots of one frame alone. Here a spot p of frame f and hole h is ``p = a_h + o_h +
D_f + d_f + e``: drawn place, what the hole is off, displacement that the fitted sensor casts for
the calibration's direction, what that direction is off, and noise. o, d and e are Gaussian; their
variances are the samples' own, so that directions count as far as they agree with the spots.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import tangents_from_sun
from algorithms.calibration.calibrated import Columns
from algorithms.calibration.forward import TURNS, ForwardModel, inward
from algorithms.calibration.parametric import FreeParameter
from algorithms.contract import Floats, UnusableDataError

Holes = NDArray[np.int64]

#: Variances to begin with, px^2: of spots, holes and directions; least of any.
_FIRST, _FLOOR = (1e-4, 1e-2, 1e-5), 1e-10
#: Rounds of holes and sensor by turns; steps of expectation and maximisation in each.
_ROUNDS, _EXPECTATIONS = 4, 3
#: Spots so many times the median deviation off are left out; px that are no deviation.
_WORST, _LEAST_PX = 6.0, 0.002
#: A spot's variance grows with this power of 1/cos^2: it is dimmer and wider, mostly one way.
_GROWTH = 3.0
_OUTWARD = ("outward_1", "outward_2", "outward_3")


class Sightings(NamedTuple):
    """Spots (S, 2), px, each of a frame (S,) and a hole (S,)."""

    spots: Floats
    frames: Holes
    holes: Holes


def hole_offsets(
    away: Floats, seen: Sightings, weights: Floats, variances: tuple[float, float, float]
) -> tuple[Floats, Floats, tuple[float, float, float]]:
    """Best linear unbiased prediction of what holes are off, and how sure that is.

    Parameters
    ----------
    away : ndarray, shape (S, 2)
        Spots less their drawn places and their frames' displacements, px.
    seen : Sightings
        Whose they are.
    weights : ndarray, shape (F,)
        Of each frame's spots: one over their variance, up to a factor.
    variances : tuple of float
        Of a spot of weight 1, of holes and of directions, px^2, to begin with.

    Returns
    -------
    tuple
        Offsets (A, 2) of the holes numbered 0 to A - 1, variances (A,), and the three variances.
    """
    spot, hole, frame = variances
    number, count = len(weights), int(seen.holes.max()) + 1
    shared = np.zeros((number, count))
    np.add.at(shared, (seen.frames, seen.holes), 1.0)
    per_frame = shared.sum(axis=1)
    own = weights[seen.frames][:, None] * away
    of_frame, of_hole = np.zeros((number, 2)), np.zeros((count, 2))
    np.add.at(of_frame, seen.frames, away)
    np.add.at(of_hole, seen.holes, own)
    weighed = weights @ shared
    for _ in range(_EXPECTATIONS):
        firm = per_frame + spot / (frame * weights)
        matrix = -(shared.T * (weights / firm)) @ shared
        matrix[np.diag_indices(count)] += weighed + spot / hole
        inverse = np.linalg.inv(matrix)
        offsets = inverse @ (of_hole - shared.T @ ((weights / firm)[:, None] * of_frame))
        moved = (of_frame - shared @ offsets) / firm[:, None]
        left = away - offsets[seen.holes] - moved[seen.frames]
        trace = float(np.trace(inverse))
        unsure = np.einsum("fa,ab,fb->f", shared, inverse, shared, optimize=True)
        frame_variance = spot * (1.0 / (firm * weights) + unsure / firm**2)
        known = count - spot / hole * trace + (per_frame / firm).sum()
        rest = 2.0 * max(len(away) - known, 1.0)
        hole = max(((offsets**2).sum() / 2.0 + spot * trace) / count, _FLOOR)
        frame = max(float(((moved**2).sum(axis=1) / 2.0 + frame_variance).mean()), _FLOOR)
        spot = max(float((weights[seen.frames][:, None] * left**2).sum() / rest), _FLOOR)
    return offsets, spot * np.diag(inverse), (spot, hole, frame)


@dataclass
class BuiltMask(ForwardModel):
    """A mask whose every hole has a place of its own: a subclass tells spots from each other.

    It declares the fields below and calls `settle` and `displacements`.

    Attributes
    ----------
    offsets_ : ndarray, shape (A, 2)
        What apertures are off their drawn places, px.
    doubts_ : ndarray, shape (A,)
        Variances of the offsets, px^2; of apertures never seen that of all.
    noise_ : float
        Variance of a spot for a Sun on the boresight, px^2.
    vector_ : ndarray, shape (9,)
        Focal length in mm, rotation and tilts about x and y in degrees, centre (x, y) in px, and
        how much farther outwards light lands, by the tangent's third, fifth and seventh power.
    """

    #: Deviation, px, of the bias that a spot's place on the pixels makes, before any is seen.
    phase_px: ClassVar[float] = 0.005

    apertures_px: tuple[tuple[float, float, float], ...] = field(repr=False)
    focal_length_mm: float
    pixel_pitch_mm: float
    centre_px: tuple[float, float]
    layers: tuple[tuple[float, float], ...] = ()

    offsets_: Floats = field(init=False, repr=False, compare=False)
    doubts_: Floats = field(init=False, repr=False, compare=False)
    noise_: float = field(init=False, repr=False, compare=False)

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing, and what diffraction adds to it."""
        focal, reach = self.focal_length_mm, self.focal_length_mm / self.pixel_pitch_mm
        x, y = self.centre_px
        return (
            FreeParameter("focal_length", "mm", focal, focal),
            *TURNS,
            FreeParameter("centre_x", "px", reach, x),
            FreeParameter("centre_y", "px", reach, y),
            *(FreeParameter(name, "", 1.0) for name in _OUTWARD),
        )

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """As drawn, turned as the displacements (n, 2) are against the Sun's."""
        del context
        x, y = (features - features.mean(axis=0)).T
        tangents = tangents_from_sun(sun)
        alpha, beta = (tangents - tangents.mean(axis=0)).T
        turn = math.degrees(math.atan2(x @ alpha - y @ beta, x @ beta + y @ alpha))
        return ((self.focal_length_mm, turn, 0.0, 0.0, *self.centre_px, *(0.0,) * len(_OUTWARD)),)

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent for one pixel, and where the boresight meets the detector."""
        return self.pixel_pitch_mm / self.focal_length_mm, self.centre_px

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) displacement of the mask's light, px, behind its cover glass."""
        square = (tangents**2).sum(axis=1)
        way = vector[0] + self.focal_length_mm * square * (
            vector[6] + square * (vector[7] + square * vector[8])
        )
        for thickness, index in self.layers:
            way += thickness * (1.0 / np.sqrt(index**2 + (index**2 - 1.0) * square) - 1.0)
        return np.asarray(vector[4:6] + tangents * (way / self.pixel_pitch_mm)[:, None])

    def settle(self, spots: Floats, holes: Holes, places: Floats, sun: Floats) -> None:
        """Learn from spots (N, K, 2) of the holes (N, K), -1 for none, drawn at places (A, 2)."""
        self.offsets_, self.doubts_ = np.zeros_like(places), np.zeros(len(places))
        self.noise_, variances = _FIRST[0], _FIRST
        frames, columns = np.nonzero(holes >= 0)
        which, index = np.unique(holes[frames, columns], return_inverse=True)
        seen = Sightings(spots[frames, columns], frames, index)
        if len(which) == 0:
            raise UnusableDataError(
                f"{self.about.name}: no spot of the calibration is known for its opening"
            )
        for _ in range(_ROUNDS):
            moved = self.displacements(spots, holes, places)
            known = np.isfinite(moved[:, 0])
            ForwardModel.learn(self, moved[known], sun[known], {})
            cast = self.cast(self.vector_, inward(sun, self.turns(self.vector_)))
            away = seen.spots - places[which[index]] - cast[frames]
            weights = self.noise_ / self._variances(cast)
            offsets, doubts, variances = hole_offsets(away, seen, weights, variances)
            self.offsets_[which], self.doubts_[:] = offsets, variances[1]
            self.doubts_[which] = doubts
            self.noise_ = variances[0]

    def displacements(self, spots: Floats, holes: Holes, places: Floats) -> Floats:
        """Displacements (N, 2) of spots (N, K, 2); NaN rows where no spot is identified.

        Weighed means, freed of the bias ``b sin(2 pi x)`` that pixels make alike for all spots of a
        frame, each axis by itself.
        """
        told = holes >= 0
        away = spots - (places + self.offsets_)[np.maximum(holes, 0)]
        rough = np.full((len(spots), 2), np.nan)
        some = told.any(axis=1)
        rough[some] = np.nanmedian(np.where(told[some][:, :, None], away[some], np.nan), axis=1)
        doubts = self._variances(rough)[:, None] + self.doubts_[np.maximum(holes, 0)]
        off = np.hypot(*(away - rough[:, None]).transpose(2, 0, 1)) / np.sqrt(doubts)
        usual = np.full(len(spots), np.inf)
        usual[some] = np.nanmedian(np.where(told, off, np.nan)[some], axis=1)
        limit = _WORST * np.maximum(usual, _LEAST_PX / np.sqrt(doubts).max(axis=1))
        weights = np.where(told & (off <= limit[:, None]), 1.0 / doubts, 0.0)[:, :, None]
        waves = np.sin(2.0 * np.pi * np.nan_to_num(spots))
        away = np.where(weights > 0.0, away, 0.0)
        total, one = weights.sum(axis=1), (weights * waves).sum(axis=1)
        two = (weights * waves * waves).sum(axis=1) + 1.0 / self.phase_px**2
        plain, waved = (weights * away).sum(axis=1), (weights * waves * away).sum(axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            found = (plain * two - waved * one) / (total * two - one * one)
        return np.where(total > 0.0, found, np.nan)

    def _variances(self, displacements: Floats) -> Floats:
        """(N,) variance of a spot, px^2, for light displaced that far."""
        slope, centre = self.drawing()
        square = (((displacements - np.asarray(centre)) * slope) ** 2).sum(axis=1)
        return np.asarray(self.noise_ * (1.0 + np.nan_to_num(square)) ** _GROWTH)
