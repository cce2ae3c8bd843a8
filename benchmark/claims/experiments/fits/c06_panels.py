"""C06: every panel's own relation beside one averaged curve a pair of panels (Richie2015).

Units of `pva-maskless-panels` are calibrated with `trig`, the direct relation of the scaled
measurement, and with `trig-averaged`, the averaged combined panel curve fit, and tested on the same
Suns. Lines run over the angle between the Sun and the panel that faces it most; two more show the
same panels with Lambert's cosine, where neither curve has a loss at grazing light to follow.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.non_physical.panel_curves import AveragedPanelCurves
from algorithms.models.non_physical.trigonometric import TrigonometricPanels
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.datasets.standard import pva_maskless_panels

#: Nobody is farther than 54.7 degrees from the nearest axis.
EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 55.0)


def trial(number: int) -> Trial:
    """Measure one unit."""
    direct, averaged, lines = math.nan, math.nan, dict[str, Line]()
    for condition in ("nominal", "cosine"):
        seen = ConditionView(pva_maskless_panels.PRESET, condition, unit=number)
        nearest = np.degrees(np.arccos(np.abs(seen.samples("test").sun).max(axis=1)))
        one = seen.errors(DirectSignals, AveragedPanelCurves)
        other = seen.errors(DirectSignals, TrigonometricPanels)
        for name, errors in (("trig-averaged", one), ("trig (direct)", other)):
            line = middles(EDGES_DEG), rms_within(errors, nearest, EDGES_DEG)
            lines[name if condition == "nominal" else f"{name}, {condition}"] = line
        if condition == "nominal":
            averaged, direct = rms(one), rms(other)
    return Trial({"direct": ratio(averaged, direct)}, lines)
