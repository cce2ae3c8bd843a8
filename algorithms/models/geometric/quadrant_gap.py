"""The QPD model: balances of a spot that loses light to the gap (Faizullin2017)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, Self

import numpy as np

from algorithms.calibration.forward import TURNS, ForwardModel
from algorithms.calibration.parametric import FreeParameter
from algorithms.contract import AboutModel, FeatureKind, Floats, SensorGeometry
from algorithms.documented import documented
from algorithms.parameters import require_choice, require_positive

Shape = Literal["round", "square"]

#: Of the square of a balance's slope, over its largest: at a spot's rim a balance says little.
_FLATTEST = 0.05


@documented
@dataclass
class QuadrantGap(ForwardModel):
    """Spot of one aperture on four photodiodes with a fitted gap between them.

    The signals lack the light that falls into the gap, most of all when the spot is centred on it.
    The position of the spot follows from the lit areas of the quadrants.

    Parameters
    ----------
    aperture_width_mm : float
        Diameter of a round aperture, side of a square one, positive.
    aperture_shape : {"round", "square"}
        Shape of the aperture, and so of the spot.
    gap_mm : float
        Between the photodiodes, at least 0 and less than the aperture; where the fit of a round
        spot's starts, and what a square spot's stays.

    Attributes
    ----------
    vector_ : ndarray, shape (6,) or (7,)
        Focal length, place (x, y) of the spot on the boresight, mm; the head's rotation and tilts
        about x and y in degrees; of a round aperture the gap, mm.

    Notes
    -----
    Implements: eq:gapcomp (model:qpd, Faizullin2017): ``G_i = S_Gi / k_G (A + B + C + D) / (S_A +
    S_B + S_C + S_D)`` is the light that falls into a piece of the gap: its lit area, times the
    signals over the lit areas of the quadrants. Added to the signals it gives the balance of the
    whole spot. All areas follow from the spot's place, which is wanted; so the equation is solved,
    by Newton's method, for the place whose ``S_A .. S_D`` have the balances measured, ``s_a = (S_B
    + S_C - S_A - S_D) / (S_A + S_B + S_C + S_D)`` and as much for ``s_b`` (alg:VB). The coefficient
    k_G makes up for a gap that is not known; here its width is fitted instead. Behind a square
    aperture the balance is ``2 X / (d - gap)``, exactly linear: focal length and gap have the same
    effect, so the gap keeps its drawn value. Ours: the head's turns.

    Shapes: balances ``(s_a, s_b)`` (N, 2), dimensionless, to unit vectors (N, 3).

    Failure: a NaN row for a NaN feature row, outside the hull, where a balance is not within (-1,
    1) (all light on one half) and where the steps have not converged within 6e-8 deg. fit raises
    UnusableDataError below 4 samples, where they do not determine the parameters or are
    inconsistent. A detector that cuts the spot off, and walls of the aperture, are not known.

    Cost: of a round aperture 30 times 150 operations per sample, of a square one 30 times 20.

    Examples
    --------
    >>> import numpy as np
    >>> from algorithms.examples import sun_grid
    >>> sun = sun_grid(range(-30, 31, 15))
    >>> model = QuadrantGap(focal_length_mm=1.0, aperture_width_mm=2.0, aperture_shape="round")
    >>> gapped = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.2])
    >>> balances = model.cast(gapped, sun[:, :2] / sun[:, 2:])
    >>> round(model.fit(balances, sun).quality_.parameter("gap").value, 6)
    0.2
    """

    about: ClassVar = AboutModel(
        name="qpd",
        taxonomy="QPD",
        studies=("Faizullin2017",),
        labels=("model:qpd", "eq:gapcomp", "alg:VB"),
        origin="survey",
        needs=("focal_length_mm", "aperture_width_mm", "aperture_shape"),
        accepts=frozenset({FeatureKind.BALANCE}),
    )

    focal_length_mm: float
    aperture_width_mm: float
    aperture_shape: Shape = "round"
    gap_mm: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        by = self.about.name
        require_positive(
            by, focal_length_mm=self.focal_length_mm, aperture_width_mm=self.aperture_width_mm
        )
        require_choice(by, Shape, aperture_shape=self.aperture_shape)
        if not 0 <= self.gap_mm < self.aperture_width_mm:
            raise ValueError(
                f"{by}: gap_mm must be in [0, {self.aperture_width_mm}); got {self.gap_mm!r}"
            )

    @classmethod
    def for_sensor(cls, geometry: SensorGeometry, kind: FeatureKind) -> Self:
        """Return the model that starts from the sensor's drawing."""
        cls.about.require_kind(kind)
        geometry.require(*cls.about.needs, by=cls.about.name)
        return cls(
            focal_length_mm=geometry.focal_length_mm or 0.0,
            aperture_width_mm=geometry.aperture_width_mm or 0.0,
            aperture_shape=geometry.aperture_shape or "round",
            gap_mm=geometry.gap_mm or 0.0,
        )

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Of the drawing; the gap of a square spot is not told from the focal length."""
        focal = self.focal_length_mm
        gap: tuple[FreeParameter, ...] = ()
        if self.aperture_shape == "round":
            gap = (FreeParameter("gap", "mm", self.aperture_width_mm, self.gap_mm),)
        return (
            FreeParameter("focal_length", "mm", focal, focal),
            FreeParameter("centre_x", "mm", focal),
            FreeParameter("centre_y", "mm", focal),
            *TURNS,
            *gap,
        )

    def drawing(self) -> tuple[float, tuple[float, float]]:
        """Tangent of a balance of 1 by the straight line, and no balance."""
        lit = self.aperture_width_mm - self.gap_mm
        return lit / 2.0 / self.focal_length_mm, (0.0, 0.0)

    def slopes(self, sun: Floats) -> Floats | float:
        """Tangents for a unit of balance; of a round spot ``pi / (4 sqrt(1 - X^2))`` radii."""
        straight, _ = self.drawing()
        if self.aperture_shape == "square":
            return straight
        places = sun[:, :2] / sun[:, 2:] * (2.0 * self.focal_length_mm / self.aperture_width_mm)
        return np.asarray(straight * np.pi / 4.0 / np.sqrt(np.maximum(1.0 - places**2, _FLATTEST)))

    def cast(self, vector: Floats, tangents: Floats) -> Floats:
        """(N, 2) balances of tangents (N, 2); NaN where all light is on one half."""
        places: Floats = vector[0] * tangents + vector[1:3]
        if self.aperture_shape == "square":
            balances = places * (2.0 / (self.aperture_width_mm - self.gap_mm))
        else:
            balances = _round_balances(
                places * (2.0 / self.aperture_width_mm), vector[6] / self.aperture_width_mm
            )
        with np.errstate(invalid="ignore"):
            balances[~(np.abs(balances) < 1.0).all(axis=1)] = np.nan
        return balances


def _round_balances(places: Floats, half_gap: float) -> Floats:
    """Balances (N, 2) of discs at places (N, 2), in radii, over quadrants half a gap off."""
    x, y = places.T
    edges_x, edges_y = half_gap + np.array([-x, x, -x, x]), half_gap + np.array([-y, -y, y, y])
    areas = corner_area(edges_x.ravel(), edges_y.ravel()).reshape(4, -1)
    right_up, left_up, right_down, left_down = areas
    with np.errstate(invalid="ignore", divide="ignore"):
        total = right_up + right_down + left_up + left_down
        along_x = ((right_up + right_down) - (left_up + left_down)) / total
        along_y = ((right_up + left_up) - (right_down + left_down)) / total
    return np.stack([along_x, along_y], axis=1)


def corner_area(a: Floats, b: Floats) -> Floats:
    """Area (N,) of the unit disc where ``x > a`` and ``y > b``, a and b (N,).

    Examples
    --------
    >>> nowhere, quarter = corner_area(np.array([1.0, 0.0]), np.zeros(2)) / np.pi
    >>> float(nowhere), float(quarter)
    (0.0, 0.25)
    """
    a, b = np.clip(a, -1.0, 1.0), np.clip(b, -1.0, 1.0)
    # the strip x > a of the disc above b, up to where b leaves the disc; all of it beyond, if b < 0
    end = np.sqrt(1.0 - b * b)
    start = np.clip(a, -end, end)
    strip = _under_arc(end) - _under_arc(start) - b * (end - start)
    beyond = np.where(b < 0, np.pi / 2.0 - 2.0 * _under_arc(np.maximum(a, end)), 0.0)
    before = np.where(b < 0, 2.0 * (_under_arc(-end) - _under_arc(np.minimum(a, -end))), 0.0)
    return np.asarray(strip + beyond + before)


def _under_arc(x: Floats) -> Floats:
    """Area (N,) between the upper arc of the unit disc and its diameter, from 0 to x."""
    return np.asarray((x * np.sqrt(1.0 - x * x) + np.arcsin(x)) / 2.0)
