"""C45: lines by votes beside the thresholded centroid, in noise and with pixels missing (Liu2016).

Overexposed crosses of two slits in 96 x 96 px, turned by up to 10 deg: arms of 24 px to each side,
3 px wide, all at the converter's end but for their rims. `hough-lines` finds one line in a frame
and the Sun on it by its halo, which a slit has not: the line across is found in the transposed
frame, and the truth is where both meet. The cross is symmetric, so its thresholded centroid is
there, too. Missing pixels read the dark level.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.cameras.hough import HoughLines
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.seeds import generator
from benchmark.synthetic_features.shapes import EDGE_PX, Shape, render

SKETCH = Sketch()

MISSING = (0.0, 0.05, 0.1, 0.2, 0.3, 0.4)
NOISES = (0.01, 0.02, 0.05, 0.1)
_FRAMES, _SIZE_PX, _RANGE_PX, _TURN = 100, 96, 12.0, np.radians(10.0)
_ARM_PX, _HALF_PX, _OVEREXPOSED = 24.0, 1.5, 1.5
_REACH_PX = _ARM_PX + 6.0 * EDGE_PX
#: The turn is known to be small; everything else is as it ships.
LINES = HoughLines(tilt_deg=20.0)


def trial(number: int) -> Trial:
    """Measure one draw of crosses, noise and missing pixels."""
    rng = generator("claims", "C45", number)
    centres = (_SIZE_PX - 1) / 2.0 + rng.uniform(-_RANGE_PX, _RANGE_PX, (_FRAMES, 2))
    light = render(_CROSS, centres, rng.uniform(-_TURN, _TURN, _FRAMES), _SIZE_PX)
    light = np.minimum(_OVEREXPOSED * light, 1.0)
    noise, lot = rng.standard_normal(light.shape), rng.random(light.shape)

    def frames(share: float, missing: float) -> Floats:
        # the converter ends where the light is one
        return np.where(lot < missing, 0.0, np.minimum(light + share * noise, 1.0))

    gaps = [frames(NOISES[0], missing) for missing in MISSING]
    loud = [frames(share, 0.0) for share in NOISES]
    bctm = ThresholdedCentroid()
    errors = {
        "hough-lines": [error_px(crossings(f), centres) for f in gaps],
        "bctm": [error_px(bctm.extract(f), centres) for f in gaps],
        "hough-lines, no gaps, noise across": [error_px(crossings(f), centres) for f in loud],
        "bctm, no gaps, noise across": [error_px(bctm.extract(f), centres) for f in loud],
    }
    at = MISSING.index(0.2)
    voted, summed, voted_loud, summed_loud = errors.values()
    found = 1.0 - float(np.isnan(crossings(gaps[at])).any(axis=1).mean())
    values = {
        "gaps": ratio(ratio(summed[at], summed[0]), ratio(voted[at], voted[0])),
        "noise": ratio(
            ratio(summed_loud[-1], summed_loud[0]), ratio(voted_loud[-1], voted_loud[0])
        ),
        "found": found,
    }
    places = (MISSING, MISSING, NOISES, NOISES)
    lines = {
        name: (where, along) for (name, along), where in zip(errors.items(), places, strict=True)
    }
    return Trial(values, lines)


def crossings(frames: Floats) -> Floats:
    """Where the line along the columns meets the one along the rows, (N, 2); NaN without one."""
    x0, y0, x1, y1 = LINES.lines(frames)[:, :4].T
    v0, u0, v1, u1 = LINES.lines(np.ascontiguousarray(frames.transpose(0, 2, 1)))[:, :4].T
    # x = a + b y along the columns, y = c + d x along the rows
    b, d = (x1 - x0) / (y1 - y0), (v1 - v0) / (u1 - u0)
    a, c = x0 - b * y0, v0 - d * u0
    x = (a + b * c) / (1.0 - b * d)
    return np.column_stack([x, c + d * x])


def _light(x: Floats, y: Floats, turn: float) -> Floats:
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy where frames are drawn

    cosine, sine = np.cos(turn), np.sin(turn)
    u, v = np.abs(x * cosine + y * sine), np.abs(y * cosine - x * sine)
    upright = ndtr((_HALF_PX - u) / EDGE_PX) * ndtr((_ARM_PX - v) / EDGE_PX)
    flat = ndtr((_ARM_PX - u) / EDGE_PX) * ndtr((_HALF_PX - v) / EDGE_PX)
    return np.asarray(np.maximum(upright, flat))


_CROSS = Shape(_light, _HALF_PX, _ARM_PX, _REACH_PX)
