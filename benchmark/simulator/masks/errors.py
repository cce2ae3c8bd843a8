"""How the built mask differs from its drawing: `MaskErrors`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from algorithms.contract import Floats
from benchmark.seeds import generator
from benchmark.simulator.masks.apertures import RECTANGLE, Mask


@dataclass(frozen=True)
class MaskErrors:
    """Errors of manufacture and of age; standard deviations unless said otherwise.

    Attributes
    ----------
    position_mm
        Of every aperture's centre, an axis.
    size_mm
        Of one over-etch common to the whole unit: all full sizes grow by the same amount.
    edge_mm
        Of every aperture's four sides, each moved by itself along its normal. A round rim is
        taken to first order: the sides' mean changes its radius, their differences move it; how
        much it stays from a circle is left out.
    rotation_deg
        Of every rectangle by itself.
    missing
        Share of the apertures that are closed; exactly the nearest whole number of them.
    dirty
        Share of the apertures, missing ones apart, that pass part of the light only.
    dirty_transmission
        Least and largest light a dirty aperture passes; uniform between them.
    """

    position_mm: float = 0.0
    size_mm: float = 0.0
    edge_mm: float = 0.0
    rotation_deg: float = 0.0
    missing: float = 0.0
    dirty: float = 0.0
    dirty_transmission: tuple[float, float] = (0.2, 0.8)

    def __post_init__(self) -> None:
        if min(self.position_mm, self.size_mm, self.edge_mm, self.rotation_deg) < 0:
            raise ValueError("standard deviations of a mask's errors must not be negative")
        if not (self.missing >= 0 and self.dirty >= 0 and self.missing + self.dirty <= 1):
            raise ValueError(
                "missing and dirty are shares of the apertures, together at most 1; got "
                f"{self.missing} and {self.dirty}"
            )
        low, high = self.dirty_transmission
        if not 0 <= low <= high <= 1:
            raise ValueError(
                "dirty_transmission must be two increasing numbers in [0, 1]; got "
                f"{self.dirty_transmission}"
            )

    @property
    def radius_mm(self) -> float:
        """Standard deviation of a round hole's radius: half the unit's size, the mean of sides."""
        return math.hypot(self.size_mm, self.edge_mm) / 2.0

    def built(self, mask: Mask, *names: str | int) -> tuple[Floats, Floats]:
        """Build the unit of this name.

        Each kind of error has its own stream, so that one unit keeps its errors whatever else
        is switched on.

        Parameters
        ----------
        mask
            As drawn.
        names
            Of the unit.

        Returns
        -------
        table
            (A, 7) as `Mask.table`, mm.
        transmission
            (A,) share of the light passed: 1 open, 0 missing.
        """
        table = mask.table()
        count = len(table)
        box = table[:, 0] == RECTANGLE
        cosine, sine = table[:, 5].copy(), table[:, 6].copy()
        place = self.position_mm * generator(*names, "aperture-position").standard_normal(
            (count, 2)
        )
        # outward moves of the sides -x, +x, -y, +y
        sides = self.edge_mm * generator(*names, "aperture-edge").standard_normal((count, 4))
        growth = self.size_mm * generator(*names, "aperture-size").standard_normal() / 2.0
        across, along = (sides[:, 1] - sides[:, 0]) / 2.0, (sides[:, 3] - sides[:, 2]) / 2.0
        table[:, 1] += place[:, 0] + cosine * across - sine * along
        table[:, 2] += place[:, 1] + sine * across + cosine * along
        wider, taller = (sides[:, 0] + sides[:, 1]) / 2.0, (sides[:, 2] + sides[:, 3]) / 2.0
        radius = (wider + taller) / 2.0
        table[:, 3] += growth + np.where(box, wider, radius)
        table[:, 4] += growth + np.where(box, taller, radius)
        np.maximum(table[:, 3:5], 0.0, out=table[:, 3:5])
        turn = generator(*names, "aperture-rotation").standard_normal(count)
        if self.rotation_deg > 0:
            # a small turn: the tangent half-angle form needs no sine of the processor's
            half = np.radians(self.rotation_deg * turn) / 2.0
            c, s = (1.0 - half**2) / (1.0 + half**2), 2.0 * half / (1.0 + half**2)
            table[:, 5] = np.where(box, cosine * c - sine * s, cosine)
            table[:, 6] = np.where(box, sine * c + cosine * s, sine)
        return table, self._transmission(count, *names)

    def _transmission(self, count: int, *names: str | int) -> Floats:
        order = generator(*names, "aperture-order").permutation(count)
        low, high = self.dirty_transmission
        passed = low + (high - low) * generator(*names, "aperture-dirt").random(count)
        closed = round(self.missing * count)
        stained = order[closed : closed + round(self.dirty * count)]
        transmission = np.ones(count)
        transmission[order[:closed]] = 0.0
        transmission[stained] = passed[stained]
        return transmission
