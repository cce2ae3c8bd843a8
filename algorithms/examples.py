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
