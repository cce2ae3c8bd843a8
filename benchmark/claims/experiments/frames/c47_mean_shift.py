"""C47: the multi-point mean shift with spots missing, and on a moving grid (You2011).

Grids of 10 x 10 spots of which a share is missing, drawn anew in every frame. For the tracking the
grid moves by 1.5 px a frame around a circle of 4 px with 30 % of the spots missing; a step is lost
where there is no answer or one more than 3 px off.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.extractors.frames.multi_spot.mean_shift import MeanShift
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.claims.experiments.frames.spot_grids import (
    SIZE_PX,
    grid_frames,
    grid_geometry,
    middles_px,
    present,
)
from benchmark.synthetic_features.series import KEPT_PX

SKETCH = Sketch()

SHARES = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7)
FRAMES, STEPS = 30, 60
MISSING, MOVE_PX, CIRCLE_PX = 0.3, 1.5, 4.0


def trial(number: int) -> Trial:
    """Measure one draw of places, missing spots and noise."""
    method = MeanShift.for_sensor(grid_geometry())
    middles = middles_px("C47", number, FRAMES)
    errors, found = [], []
    for share in SHARES:
        there = present("C47", number, FRAMES, share)
        said = method.extract(grid_frames("C47", number, middles, there))
        errors.append(error_px(said, middles))
        found.append(1.0 - float(np.isnan(said).any(axis=1).mean()))
    at = SHARES.index(MISSING)
    values = {
        "found": found[at],
        "survives": ratio(errors[at], errors[0]),
        "tracks": _lost(number, method),
    }
    return Trial(values, {"fmms": (SHARES, errors)})


def _lost(number: int, method: MeanShift) -> float:
    """Share of steps after which the grid is not followed."""
    turn = MOVE_PX / CIRCLE_PX * np.arange(STEPS) + 2.0 * math.pi * number / 7.0
    places = (SIZE_PX - 1) / 2.0 + CIRCLE_PX * np.column_stack([np.cos(turn), np.sin(turn)])
    there = present("C47", number, STEPS, MISSING)
    said = method.track(grid_frames("C47", number, places, there, "noise of the track"))
    kept = np.hypot(*(said - places).T) <= KEPT_PX
    return 1.0 - float(kept.mean())
