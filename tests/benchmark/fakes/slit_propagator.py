"""Profiles behind slits by the angular spectrum: an oracle that shares nothing with the simulator.

Every wavelength of every point of the Sun is a plane wave. Cut by an endless slit it is a sum of
plane waves of one and the same wavenumber along the slit; each is carried through the foil, to its
lower rim, through the gap and through glass with its own ``k_z``, no approximation made of it. The
frame moves with the undiffracted ray. Intensities are added up and integrated over the pixels.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy import fft

#: Sampling of the field, micrometres.
STEP_UM, SAMPLES = 0.4, 2**13
#: Quantum efficiencies of `SUNLIT_SILICON`, as its comment states them.
QE_NM = (450.0, 550.0, 650.0, 750.0, 850.0, 950.0)
QE = (0.50, 0.60, 0.50, 0.35, 0.20, 0.08)


@dataclass(frozen=True)
class Line:
    """A line of pixels behind slits (width, position, slant); lengths in mm, angles in deg."""

    slits: tuple[tuple[float, float, float], ...]
    height: float
    thickness: float
    glass: tuple[tuple[float, float], ...]
    pitch: float
    columns: int
    pixel_height: float
    fill: float


def sunlight(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths, nm, and shares of the electrons: photons of 5772 K times quantum efficiency.

    `count` equal bands from 400 to 1000 nm; efficiencies between the stated ones and beyond them
    on straight lines.
    """
    nm = 400.0 + (np.arange(count) + 0.5) * 600.0 / count
    photons = nm**-4.0 / np.expm1(1.438777e7 / (nm * 5772.0))
    low = QE[0] + (nm - 450.0) * (QE[1] - QE[0]) / 100.0
    high = QE[-1] + (nm - 950.0) * (QE[-1] - QE[-2]) / 100.0
    efficiency = np.where(nm < 450, low, np.where(nm > 950, high, np.interp(nm, QE_NM, QE)))
    weights = photons * efficiency
    return nm, weights / weights.sum()


def disc(sun: np.ndarray, rings: int = 9, spokes: int = 24) -> tuple[np.ndarray, np.ndarray]:
    """Directions (K, 3) and shares of a limb-darkened Sun, 0.533 deg wide: rings of equal area."""
    helper = np.array([0.2, 0.5, -0.7])
    one = np.cross(sun, helper)
    one /= np.linalg.norm(one)
    two = np.cross(sun, one)
    square = (np.arange(rings) + 0.5) / rings
    turn = 2 * np.pi * (np.arange(spokes) + 0.37 * np.arange(rings)[:, None]) / spokes
    radius = math.sin(math.radians(0.533 / 2)) * np.sqrt(square)[:, None]
    x, y = (radius * np.cos(turn)).ravel(), (radius * np.sin(turn)).ravel()
    light = np.repeat(1 - 0.6 * (1 - np.sqrt(1 - square)), spokes)
    onward = np.sqrt(1 - x**2 - y**2)
    return onward[:, None] * sun + x[:, None] * one + y[:, None] * two, light / light.sum()


def passed(cosine: np.ndarray, index: float) -> np.ndarray:
    """Unpolarised light through both faces of a plate in vacuum, by the angles (Fresnel)."""
    i = np.arccos(np.minimum(cosine, 1 - 1e-9))
    t = np.arcsin(np.sin(i) / index)
    across = (np.sin(i - t) / np.sin(i + t)) ** 2
    along = (np.tan(i - t) / np.tan(i + t)) ** 2
    return np.asarray(((1 - across) ** 2 + (1 - along) ** 2) / 2)


def _opening(place: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Share of each sample's cell that lies between two edges."""
    right = np.minimum(place + STEP_UM / 2, high[:, None])
    left = np.maximum(place - STEP_UM / 2, low[:, None])
    return np.asarray(np.clip((right - left) / STEP_UM, 0, 1))


def pattern(
    points: np.ndarray, slant_deg: float, width_um: float, line: Line, nm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Intensities (K, M) on places (M,) um across the shadow, from each point's own landing."""
    turn = math.radians(slant_deg)
    across = points[:, 0] * math.cos(turn) + points[:, 1] * math.sin(turn)
    along = points[:, 1] * math.cos(turn) - points[:, 0] * math.sin(turn)
    k = 2 * np.pi / (nm * 1e-3)
    place = (np.arange(SAMPLES) - SAMPLES / 2) * STEP_UM
    extra = 2 * np.pi * fft.fftfreq(SAMPLES, STEP_UM)

    def carry(field: np.ndarray, layers: list[tuple[float, float]]) -> np.ndarray:
        phase = np.zeros((len(points), SAMPLES), dtype=complex)
        for thickness, index in layers:
            rest = (k * index) ** 2 - (k * along) ** 2
            own = np.sqrt(rest - (k * across) ** 2)
            kz = np.sqrt((rest[:, None] - (k * across[:, None] + extra) ** 2).astype(complex))
            phase += thickness * (kz - own[:, None] + (k * across / own)[:, None] * extra)
        return fft.ifft(fft.fft(field, axis=1) * np.exp(1j * phase), axis=1)

    half = np.full(len(points), width_um / 2)
    field = _opening(place, -half, half).astype(complex)
    foil = line.thickness * 1e3
    if foil > 0:
        moved = foil * across / points[:, 2]
        field = carry(field, [(foil, 1.0)]) * _opening(place, -half - moved, half - moved)
    gap = 1e3 * (line.height - sum(t for t, _ in line.glass)) - foil / 2
    return place, np.abs(carry(field, [(gap, 1.0)] + [(1e3 * t, n) for t, n in line.glass])) ** 2


def profile(
    line: Line,
    sun: np.ndarray,
    nm: np.ndarray,
    weights: np.ndarray,
    points: tuple[np.ndarray, np.ndarray] | None = None,
) -> np.ndarray:
    """(columns,) light on each pixel's sensitive area; normal sunlight without glass is 1."""
    directions, shares = points or disc(np.asarray(sun, dtype=float))
    sine2 = np.sum(directions[:, :2] ** 2, axis=1)
    light = shares * directions[:, 2]
    for _, index in line.glass:
        light = light * passed(directions[:, 2], index)
    foil = line.thickness
    scale = (line.height + foil / 2 - sum(t for t, _ in line.glass)) / directions[:, 2]
    scale = scale + sum(t / np.sqrt(n * n - sine2) for t, n in line.glass)
    landing = directions[:, :2] * scale[:, None]  # of the ray through the upper rim's middle
    middles = (np.arange(line.columns) - (line.columns - 1) / 2) * line.pitch
    out = np.zeros(line.columns)
    shared: dict[tuple[float, float], np.ndarray] = {}
    for width, position, slant in line.slits:
        turn = math.radians(slant)
        if (width, slant) not in shared:
            total = 0.0
            for wave, weight in zip(nm, weights, strict=True):
                place, seen = pattern(directions, slant, 1e3 * width, line, wave)
                total = total + weight * seen
            shared[width, slant] = np.cumsum(total, axis=1) * STEP_UM
        rows = 1 if slant == 0 else 121
        lift = ((np.arange(rows) + 0.5) / rows - 0.5) * line.pixel_height
        for sums, (du, dv), share in zip(shared[width, slant], landing, light, strict=True):
            # places of the pixels' two edges across the shadow, um
            start = math.cos(turn) * (middles - position - du)
            start = 1e3 * (start[:, None] + math.sin(turn) * (lift - dv))
            reach = 1e3 * math.cos(turn) * line.fill * line.pitch / 2
            low, high = (np.interp(start + s * reach, place + STEP_UM / 2, sums) for s in (-1, 1))
            out += share * (high - low).mean(axis=1) / (2 * reach)
    return out
