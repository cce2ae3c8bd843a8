"""Errors of assembly that families share: what careful work leaves, and what all would notice."""

from __future__ import annotations

from benchmark.simulator.optics.assembly import Assembly

#: In words, for descriptions of the condition ``misalign``.
MISALIGNED = "tilted by 1.0 and -0.7 deg, turned by 0.5 deg"


def careful_alignment(
    focal_length_error_mm: float, offset_x_mm: float = 0.004, offset_y_mm: float = -0.003
) -> Assembly:
    """Return the small errors that remain after careful assembly."""
    return Assembly(
        tilt_x_deg=0.05,
        tilt_y_deg=-0.03,
        rotation_deg=0.05,
        focal_length_error_mm=focal_length_error_mm,
        offset_x_mm=offset_x_mm,
        offset_y_mm=offset_y_mm,
    )


def misalign(
    focal_length_error_mm: float, offset_x_mm: float = 0.05, offset_y_mm: float = -0.04
) -> Assembly:
    """Return errors far above the noise."""
    return Assembly(
        tilt_x_deg=1.0,
        tilt_y_deg=-0.7,
        rotation_deg=0.5,
        focal_length_error_mm=focal_length_error_mm,
        offset_x_mm=offset_x_mm,
        offset_y_mm=offset_y_mm,
    )
