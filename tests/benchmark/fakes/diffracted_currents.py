"""Currents behind openings in diffracted light: an oracle that shares nothing with the simulator.

Fresnel's transfer function on a fine grid about the chief ray: where the landing point moves by
``J ds`` with the light's direction cosines, a spatial frequency f turns by ``exp(-i pi lambda f J
f)``. The Sun is a point: its disc only evens out what is found here.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

#: Black body of 5772 K times round quantum efficiencies of silicon; nanometres, shares.
SPECTRUM = ((450.0, 0.191), (550.0, 0.283), (650.0, 0.246), (750.0, 0.164), (850.0, 0.116))


def spread(direction: np.ndarray, layers: list[tuple[float, float]]) -> np.ndarray:
    """J (2, 2): thickness and index of the layers from opening to detector."""
    sine2 = float(direction[0] ** 2 + direction[1] ** 2)
    across = sum(t / math.sqrt(n * n - sine2) for t, n in layers)
    bend = sum(t / math.sqrt(n * n - sine2) ** 3 for t, n in layers)
    return across * np.eye(2) + bend * np.outer(direction[:2], direction[:2])


def landing(direction: np.ndarray, layers: list[tuple[float, float]]) -> np.ndarray:
    """Where the chief ray falls."""
    sine2 = float(direction[0] ** 2 + direction[1] ** 2)
    return np.asarray(direction[:2] * sum(t / math.sqrt(n * n - sine2) for t, n in layers))


def pattern(opening: np.ndarray, step_mm: float, bend: np.ndarray) -> np.ndarray:
    """Intensity behind an `opening` sampled on a grid (rows y, columns x), of the spectrum."""
    fx = np.fft.fftfreq(opening.shape[1], step_mm)[None, :]
    fy = np.fft.fftfreq(opening.shape[0], step_mm)[:, None]
    phase = bend[0, 0] * fx**2 + 2.0 * bend[0, 1] * fx * fy + bend[1, 1] * fy**2
    field = np.fft.fft2(opening)
    out = np.zeros(opening.shape)
    for wavelength, share in SPECTRUM:
        turned = np.fft.ifft2(field * np.exp(-1j * math.pi * wavelength * 1e-6 * phase))
        out += share * np.abs(turned) ** 2
    return out


def sampled(
    half_mm: tuple[float, float], reach_mm: float, step_mm: float, shape: str
) -> tuple[np.ndarray, np.ndarray]:
    """An opening of these half widths, and the grid's coordinates.

    Cells are open or not, so that as much light leaves the opening as its area says.
    """
    count = 2 * round(reach_mm / step_mm)
    place = (np.arange(count) - count // 2 + 0.5) * step_mm
    x, y = place[None, :] / half_mm[0], place[:, None] / half_mm[1]
    inside = x**2 + y**2 <= 1.0 if shape == "round" else np.maximum(abs(x), abs(y)) <= 1.0
    return inside.astype(np.float64), place


def sampled_slit(half_mm: float, reach_mm: float, step_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A long slit as one row, and the grid's coordinates."""
    count = 2 * round(reach_mm / step_mm)
    place = (np.arange(count) - count // 2 + 0.5) * step_mm
    return (np.abs(place) <= half_mm).astype(np.float64)[None, :], place


def currents(
    lights: tuple[np.ndarray, ...],
    place: np.ndarray,
    spot: np.ndarray,
    elements: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> np.ndarray:
    """(L, K) light on elements, of L patterns on one grid.

    `elements` gives the (K, ...) sensitivity at x (1, C) and y (R, 1).
    """
    x, y = place[None, :] + spot[0], place[:, None] + spot[1]
    return np.einsum("lyx,kyx->lk", np.asarray(lights), np.asarray(elements(x, y)))


def covered(boxes: np.ndarray, step_mm: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Shares of each grid cell inside boxes (K, 4)."""

    def inside(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        out = []
        for left, right, low, high in boxes:
            across = np.minimum(right, x + step_mm / 2) - np.maximum(left, x - step_mm / 2)
            along = np.minimum(high, y + step_mm / 2) - np.maximum(low, y - step_mm / 2)
            out.append(np.maximum(across, 0) / step_mm * np.maximum(along, 0) / step_mm)
        return np.array(out)

    return inside
