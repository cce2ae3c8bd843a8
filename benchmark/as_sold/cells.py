"""Runs of a simulated sensor that have errors: depth of calibration, and bench."""

from __future__ import annotations

BENCHES = ("standard", "fine", "true")
"""Directions that a calibration has: of a bench of 0.016 or 0.001 deg, or the true ones."""

CELLS = (
    "uncalibrated",
    *(f"{depth}_{bench}" for depth in ("constants", "table") for bench in BENCHES),
)
"""Without a calibration there is no bench."""
