"""Electrode currents of a two-axis position-sensitive device: `PositionSensor`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from algorithms.contract import Floats
from benchmark.simulator.light.stray_slope import slope
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.optics.ghosts import Ghost
from benchmark.simulator.optics.projection import ProjectedLight
from benchmark.simulator.readout.detectors import CurrentReadout
from benchmark.simulator.scene import Scene
from benchmark.simulator.sensors.four_elements import QUADRANTS, FourElements


@dataclass(frozen=True)
class LateralEffect:
    """A square photodiode whose photocurrent divides among electrodes at its four corners.

    The electrodes lie, in the detector frame, at Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y) and
    Q4 (-x, -y): the order of a quadrant photodiode, for which alg:VB gives the x balance as
    (Q2 + Q3 - Q1 - Q4) / sum and the y balance as (Q1 + Q2 - Q3 - Q4) / sum. With both
    coordinates (u, v) of the light in units of half the active length L, each electrode takes the
    share (1 +- u)(1 +- v) / 4, so that the balances are (u, v): a spot at X has the balance
    ``S = 2 X / L``, that of a quadrant photodiode behind a square aperture of width L.

    Attributes
    ----------
    length_mm
        Side L of the active area.
    nonlinearity
        kappa: light at (x, y) divides as if at ``(x, y) (1 - kappa (x^2 + y^2))``, in units of
        half the active length; the resistive layer is not uniform and its edge pulls.
    """

    length_mm: float
    nonlinearity: float = 0.0

    def __post_init__(self) -> None:
        if not self.length_mm > 0:
            raise ValueError(f"length_mm must be positive; got {self.length_mm}")
        if not 0 <= self.nonlinearity < 1 / 6:  # beyond, one balance belongs to two places
            raise ValueError(f"nonlinearity must be in [0, 1/6); got {self.nonlinearity}")

    def shares(self, x_mm: Floats, y_mm: Floats) -> Floats:
        """(..., 4) shares of light at (x, y) that Q1..Q4 collect; 0 beyond the active area."""
        x, y = 2.0 * x_mm / self.length_mm, 2.0 * y_mm / self.length_mm
        scale = 1.0 - self.nonlinearity * (x * x + y * y)
        u, v = x * scale, y * scale
        inside = (np.abs(x) <= 1.0) & (np.abs(y) <= 1.0)
        left, right = (1.0 - u) / 2.0 * inside, (1.0 + u) / 2.0 * inside
        low, high = (1.0 - v) / 2.0, (1.0 + v) / 2.0
        return np.stack([left * high, right * high, right * low, left * low], axis=-1)


@dataclass(frozen=True)
class PositionSensor(FourElements):
    """A position-sensitive device behind one or more sharp-edged apertures.

    The spot is a finite one: every point of the Sun casts the whole aperture. The mask must be
    thin (`Mask.thickness_mm` 0), so that every such image has the aperture's own shape. Behind one
    round aperture there may be a `ghost`.
    """

    detector: LateralEffect
    readout: CurrentReadout
    ghost: Ghost | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        if self.camera.mask.thickness_mm != 0:
            raise ValueError(
                "a position sensor is simulated behind a thin mask; got thickness_mm "
                f"{self.camera.mask.thickness_mm}"
            )
        shapes = [aperture.shape for aperture in self.camera.mask.apertures]
        if self.ghost is not None and shapes != ["round"]:
            raise ValueError(f"ghosts are simulated of one round aperture; got {shapes}")

    def lit(self, scene: Scene) -> Floats:
        """(N, 4) photocurrent of the electrodes in units of all apertures at normal incidence.

        Exact (by Gauss's rule) while the spot lies whole inside the active area; light beyond it
        is lost, point by point of the rule.
        """
        collected = self._collect(self.camera.project(scene.sun))
        if self.ghost is not None:
            collected += self._again(self.ghost, scene.sun)
        return np.asarray(collected * scene.irradiance[:, None])

    def _again(self, ghost: Ghost, sun: Floats) -> Floats:
        """(N, 4) what the ghost gives: its whole image less what the aperture let out again."""
        near, far, light = ghost.paths(self.camera, sun)
        collected = self._collect(ProjectedLight(np.stack([far, far]), light), 4, 16)
        if ghost.surface == "glass":
            return collected
        hole = self.camera.mask.apertures[0]
        apart = np.sqrt(np.sum((far - near) ** 2, axis=2))
        centre = (far + near) / 2.0 + (hole.x_mm, hole.y_mm)
        for n, k in np.argwhere(apart < hole.width_mm):
            span = float(apart[n, k])
            along = (far[n, k] - near[n, k]) / span if span > 0.0 else np.array([1.0, 0.0])
            points, shares = common_rule(span / hole.width_mm)
            x = centre[n, k, 0] + hole.width_mm / 2.0 * (points @ (along * (1.0, -1.0)))
            y = centre[n, k, 1] + hole.width_mm / 2.0 * (points @ along[::-1])
            parts = self.detector.shares(x, y) * shares[:, None]
            collected[n] -= light[n, k] * np.sum(parts, axis=0)
        return collected

    def _collect(self, light: ProjectedLight, radial: int = 2, turns: int = 8) -> Floats:
        """(N, 4) shares that the electrodes take of images of the apertures, one a point."""
        apertures = self.camera.mask.apertures
        whole = sum(aperture.area_mm2 for aperture in apertures)
        collected = np.zeros((len(light.light), 4))
        for aperture in apertures:
            points, weights = aperture_rule(aperture, radial, turns)
            shares = weights * (aperture.area_mm2 / whole)
            for (x, y), share in zip(points, shares, strict=True):
                at = light.rims_mm[0] + (x, y)
                parts = self.detector.shares(at[..., 0], at[..., 1])
                collected += share * np.sum(light.light[..., None] * parts, axis=1)
        return collected

    def stray(self, scene: Scene) -> Floats:
        """(N, 4) a quarter of the stray light to each electrode."""
        # each electrode's share (1 +- u)(1 +- v) / 4 has its mean at a third of the way to it
        return slope(scene, QUADRANTS / 3.0) / 4.0


def aperture_rule(aperture: Aperture, radial: int = 2, turns: int = 8) -> tuple[Floats, Floats]:
    """Points (P, 2) in mm and weights (P,), sum 1, of a mean over an aperture's area.

    Exact for polynomials of degree 6, that of `LateralEffect.shares`; of round ones more radii and
    turns may be asked for.
    """
    if aperture.shape == "round":
        nodes, halves = np.polynomial.legendre.leggauss(radial)
        angles = [2.0 * math.pi * (step + 0.5) / turns for step in range(turns)]
        reach = aperture.width_mm / 2.0
        points = [
            (
                reach * math.sqrt((node + 1.0) / 2.0) * math.cos(turn),
                reach * math.sqrt((node + 1.0) / 2.0) * math.sin(turn),
            )
            for node in nodes
            for turn in angles
        ]
        weights = np.repeat(halves / 2.0, turns) / turns
    else:
        nodes, halves = np.polynomial.legendre.leggauss(4)
        c = math.cos(math.radians(aperture.rotation_deg))
        s = math.sin(math.radians(aperture.rotation_deg))
        a, b = aperture.width_mm / 2.0, aperture.height_mm / 2.0
        points = [(c * a * p - s * b * q, s * a * p + c * b * q) for p in nodes for q in nodes]
        weights = np.outer(halves, halves).ravel() / 4.0
    centre = np.array([aperture.x_mm, aperture.y_mm])
    return np.array(points) + centre, np.asarray(weights)


def common_rule(apart: float) -> tuple[Floats, Floats]:
    """Points (P, 2) and weights (P,) over what two equal circles share, in units of their radius.

    Coordinates from the middle between them, the first along the line of their centres; weights
    sum to the shared area over a circle's.

    Parameters
    ----------
    apart
        Distance of the centres in units of the diameter, below 1.
    """
    widest = math.acos(apart)
    (turns, outer), (places, inner) = _nodes(10), _nodes(4)
    cosine = np.array([math.cos(widest * turn) for turn in turns])
    sine = np.array([math.sin(widest * turn) for turn in turns])
    reach = cosine - apart
    along = np.outer(reach, places).ravel()
    weights = np.outer(outer * cosine * reach, inner).ravel() * (widest / math.pi)
    return np.column_stack([along, np.repeat(sine, len(places))]), weights


@lru_cache(maxsize=4)
def _nodes(count: int) -> tuple[Floats, Floats]:
    return np.polynomial.legendre.leggauss(count)
