"""Data sets whose calibration is given the true directions: what is left is the method's own error.

Readings are the same to the last bit. Where a bench is wrong by more than what a claim is about,
its error hides the effect.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TypeVar

from benchmark.datasets.calibration import Bench, Reference
from benchmark.datasets.conditions.instruments import Instruments
from benchmark.datasets.preset import Preset

Known = TypeVar("Known", bound=Preset)


def with_true_directions(preset: Known) -> Known:
    """Return the data set with readings as they are and directions (N, 3) without error."""
    setups = {name: replace(one, bench=_true(one.bench)) for name, one in preset.setups.items()}
    return replace(preset, setups=setups)


def _true(bench: Reference | None) -> Reference | None:
    if isinstance(bench, Bench):  # the lamp stays as it is
        return replace(
            bench, axis_random_deg=0.0, mounting_deg=0.0, squareness_deg=0.0, eccentricity_deg=0.0
        )
    if isinstance(bench, Instruments):
        return replace(bench, attitude_random_deg=0.0, attitude_bias_deg=0.0)
    return bench
