"""Noiseless readings of simple sensors, made for the examples in docstrings."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from algorithms.angles import sun_from_angles
from algorithms.contract import Floats

#: Half widths, px, of the slit's spot and of the disc, and width of the blurred spot.
_SLIT, _DISC, _BLUR = 3.5, 5.5, 3.0**0.5
_PEAK = 200.0


def sun_grid(angles_deg: Iterable[float]) -> Floats:
    """Return unit vectors (N, 3) to Suns at all pairs of these angles alpha and beta.

    Parameters
    ----------
    angles_deg : iterable of float
        Of either axis.

    Returns
    -------
    ndarray, shape (N, 3)
        beta runs first.

    Examples
    --------
    >>> sun_grid([0, 45]).round(2)
    array([[0.  , 0.  , 1.  ],
           [0.  , 0.71, 0.71],
           [0.71, 0.  , 0.71],
           [0.58, 0.58, 0.58]])
    """
    steps = np.array(list(angles_deg), dtype=np.float64)
    return sun_from_angles(np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2))


def spot_frame(x_px: float, y_px: float, height: int = 21, width: int = 25) -> Floats:
    """Frame (1, H, W) with a round, blurred spot of 200 at its middle; nothing else."""
    y, x = np.mgrid[:height, :width]
    return np.asarray(_PEAK * np.exp(-((x - x_px) ** 2 + (y - y_px) ** 2) / (2.0 * _BLUR**2)))[None]


def disc_frame(x_px: float, y_px: float, height: int = 31, width: int = 33) -> Floats:
    """Frame (1, H, W) with a sharp disc of 10 px and 200; nothing else."""
    y, x = np.mgrid[:height, :width]
    away = np.hypot(x - x_px, y - y_px)
    return np.asarray(_PEAK * np.clip(_DISC - away, 0, 1))[None]


def mask_frame(x_px: float, y_px: float) -> tuple[Floats, tuple[tuple[float, float, float], ...]]:
    """Frame (1, 40, 46) with the spots of four square holes about a place, and the holes, px."""
    holes = ((-8.0, -6.0, 5.0), (8.0, -5.0, 5.0), (-7.0, 7.0, 5.0), (9.0, 6.0, 5.0))
    y, x = np.mgrid[:40, :46]
    away = [np.maximum(abs(x - x_px - u), abs(y - y_px - v)) for u, v, _ in holes]
    return _PEAK * np.clip(3.0 - np.array(away), 0, 1).sum(axis=0)[None], holes


def slit_profiles(x_px: float, y_px: float) -> tuple[Floats, dict[str, Any]]:
    """Profile (1, 160) of two lines behind a slit of 6 px, and the extractor's design."""
    places = np.arange(80) - np.array([[x_px], [y_px]])
    design = {
        "line_axes": ("x", "y"),
        "line_pixels": 80,
        "slits": ((0.0, 0.0, 6.0),),
        "reach_px": 20.0,
        "margin_px": 2.0,
    }
    return _PEAK * np.clip(_SLIT - np.abs(places), 0, 1).reshape(1, -1), design


def face_signals(sun: ArrayLike, normals: ArrayLike) -> Floats:
    """Signals (N, K) of faces that follow the cosine of incidence."""
    return np.asarray(np.maximum(np.asarray(sun) @ np.asarray(normals).T, 0.0))


def turning_body() -> tuple[Floats, Floats, dict[str, Floats]]:
    """Spots (200, 2), Suns (200, 3) and context of a body that turns at 0.2 deg/s, every 10 s."""
    time = 10.0 * np.arange(200.0)
    turn = np.radians(0.2) * time
    lean = 0.5 + 0.2 * np.sin(turn / 7.0)
    swing = np.degrees(np.gradient(lean, time))
    across, along = np.sin(lean), np.cos(lean)
    sun = np.column_stack([across * np.cos(turn), across * np.sin(turn), along])
    rate = [swing * np.sin(turn), -swing * np.cos(turn), np.full(len(time), -0.2)]
    context = {
        "time_s": time,
        "eclipse": np.zeros(len(time)),
        "temperature_K": 290.0 + 5.0 * np.cos(turn),
        "nadir": -sun,
        "rate_deg_s": np.column_stack(rate),
    }
    return 100.0 * sun[:, :2] / sun[:, 2:], sun, context


def dial_signals(
    sun: ArrayLike, *, bits: int, cell_mm: float, period_mm: float, focal_length_mm: float
) -> Floats:
    """Signals (N, 2 (bits + 4)) of the tracks of two ideal code dials, along x and y."""
    rows: list[Floats] = []
    for tangents in _tangents(sun).T:
        place = focal_length_mm * tangents
        cell = np.floor(place / cell_mm).astype(int) + 2 ** (bits - 1)
        rows += [((cell ^ (cell >> 1)) >> bit) & 1 for bit in reversed(range(bits))]
        phase = 2 * np.pi * place / period_mm
        waves = np.cos(phase), np.sin(phase)
        rows += [(1 + sign * wave) / 2 for sign in (-1, 1) for wave in waves]
    return np.transpose(rows).astype(np.float64)


def slit_light(
    sun: ArrayLike,
    focal_length_mm: float,
    *,
    slits: tuple[tuple[float, float, float], ...],
    pixel_pitch_mm: float,
    centre_px: tuple[float, float],
    line_axes: tuple[str, ...],
    line_pixels: int,
) -> Floats:
    """Light (N, A L) of slits square to each of A lines of L pixels, of a Sun without width."""
    at = pixel_pitch_mm * (np.arange(line_pixels) - centre_px[0])
    lines = []
    for axis in line_axes:
        shift = focal_length_mm * _tangents(sun)[:, "xy".index(axis), None]
        away = [np.abs(at - shift - place) for place, _, _ in slits]
        edges = [
            (width / 2.0 - far) / pixel_pitch_mm + 0.5
            for far, (_, _, width) in zip(away, slits, strict=True)
        ]
        lines.append(np.clip(edges, 0.0, 1.0).sum(axis=0))
    return np.hstack(lines)


def coded_design() -> dict[str, Any]:
    """Design of a mask of 361 apertures, each a little off its place on a lattice of 30 px."""
    steps = 30.0 * np.arange(-9, 10)
    lattice = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
    holes = lattice + np.random.default_rng(1).uniform(-6.0, 6.0, lattice.shape)
    return {
        "apertures_px": tuple((x, y, 5.0) for x, y in holes.tolist()),
        "spots": 20,
        "focal_length_mm": 2.0,
        "pixel_pitch_mm": 0.01,
        "centre_px": (49.5, 49.5),
        "size_px": (100.0, 100.0),
    }


def coded_lists(sun: ArrayLike) -> Floats:
    """Spots (N, 60) of the mask of `coded_design` that fall on its detector."""
    holes = np.array(coded_design()["apertures_px"])[:, :2]
    tangents = _tangents(sun)
    lists = np.zeros((len(tangents), 20, 3))
    for row, tangent in zip(lists, tangents, strict=True):
        away = holes + 200.0 * tangent
        seen = away[(np.abs(away) < 44.0).all(axis=1)]
        row[: len(seen), :2], row[: len(seen), 2] = 49.5 + seen, 1.0
    return lists.reshape(len(lists), -1)


def _tangents(sun: ArrayLike) -> Floats:
    vectors = np.asarray(sun, dtype=np.float64)
    return np.asarray(vectors[:, :2] / vectors[:, 2:])
