"""Pixels that only count what falls on them, for tests whose oracle knows of light alone."""

from __future__ import annotations

from dataclasses import replace

from benchmark.simulator.readout.detectors import PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors


def bare(detector: PixelArray) -> PixelArray:
    """Return the same pixels without walls in the way of oblique light, and without their errors.

    What walls and errors do has its own tests, in ``test_pixel_errors_read.py``.
    """
    return replace(detector, tunnel=0.0, errors=PixelErrors())
