"""Intervals as a calibration's document holds them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from calibrate.intervals.grazing import Grazing
from calibrate.uncertainty import Intervals


def stored_intervals(found: Intervals | Grazing) -> dict[str, Any]:
    """Return intervals as what JSON can say."""
    return {
        name: (
            value.tolist()
            if isinstance(value, np.ndarray)
            else (stored_intervals(value) if isinstance(value, Grazing) else value)
        )
        for name, value in vars(found).items()
    }


def intervals_of(stored: Mapping[str, Any] | None) -> Intervals | None:
    """Return the intervals that a document holds; ValueError where they are none."""
    if stored is None:
        return None
    axis, rings_deg, sigma_deg = (
        np.asarray(stored[name], dtype=np.float64) for name in ("axis", "rings_deg", "sigma_deg")
    )
    found = Intervals(
        float(stored["factor"]), float(stored["coverage"]), int(stored["samples"]), axis, rings_deg,
        int(stored["sectors"]), sigma_deg, _grazing_of(stored.get("grazing")),
    )  # fmt: skip
    shape = (len(found.rings_deg), found.sectors, 2)
    if found.axis.shape != (3,) or found.sigma_deg.shape != shape:
        raise ValueError(
            f"expected intervals of shape {shape} about an axis of 3; got {found.sigma_deg.shape} "
            f"about {found.axis.shape}"
        )
    return found


def _grazing_of(stored: Mapping[str, Any] | None) -> Grazing:
    """Return the growth of errors at grazing light that a document holds; none in older ones."""
    if stored is None or not stored["normals"]:
        return Grazing.none()
    normals = np.asarray(stored["normals"], dtype=np.float64)
    found = Grazing(normals, float(stored["sine"]), float(stored["grown"]))
    if normals.ndim != 2 or normals.shape[1] != 3 or not (found.sine > 0 and found.grown >= 0):
        raise ValueError(
            "expected grazing with normals of three numbers, a positive sine and grown of 0 or more"
        )
    return found
