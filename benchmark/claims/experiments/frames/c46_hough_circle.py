"""C46: the circle's votes beside the thresholded centroid, on clean and on corrupted discs.

A share of the disc's area is corrupted: a third of it in one round gap of no light on the disc, a
third in single dead pixels of the disc, and a third as a round glint as bright as the Sun that
touches the disc's rim or lies up to 6 px beyond it. Noise is 1 % of the peak. The rules compare
discs that are clean with those of which 20 % is corrupted. Known is that the image is a circle;
its radius is not, as the survey states, and votes count for any radius, as the method ships. With
votes for radii from 6 to 10 px alone the method is a line of its own.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.frames.cameras.hough import HoughCircle
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import (
    RADIUS_PX,
    SIZE_PX,
    Spots,
    errors_px,
    ship,
    single,
)
from benchmark.seeds import generator
from benchmark.synthetic_features.shapes import EDGE_PX

SKETCH = Sketch()

SHARES = (0.0, 0.05, 0.1, 0.2, 0.3)
CORRUPTED = 0.2
NOISE = 0.01
_BEYOND_PX = 6.0


def trial(number: int) -> Trial:
    """Measure one draw of discs, corruption and noise."""
    drawn = single("C46", number)
    methods = {
        "hough-circle": ship(HoughCircle),
        "hough-circle, radius known": HoughCircle(smallest_px=6.0, largest_px=10.0),
        "bctm": ship(ThresholdedCentroid),
    }
    lines: dict[str, list[float]] = {name: [] for name in methods}
    for share in SHARES:
        seen = corrupt(drawn, share, generator("claims", "C46", number, "corruption"))
        for name, errors in errors_px(seen, methods, (NOISE,)).items():
            lines[name] += errors
    at = SHARES.index(CORRUPTED)
    clean, spoilt = (ratio(lines["bctm"][k], lines["hough-circle"][k]) for k in (0, at))
    values = {"imperfect": spoilt, "best": ratio(spoilt, clean)}
    return Trial(values, {name: (SHARES, along) for name, along in lines.items()})


def corrupt(drawn: Spots, share: float, rng: np.random.Generator) -> Spots:
    """Discs of whose area a share is corrupted; the same gaps and pixels grow with the share."""
    count = len(drawn.light)
    part = RADIUS_PX * math.sqrt(share / 3.0)
    turn = rng.uniform(0.0, 2.0 * math.pi, (2, count))
    inside = (RADIUS_PX - part) * np.sqrt(rng.random(count))
    beyond = RADIUS_PX + part + _BEYOND_PX * rng.random(count)
    lot = rng.random(drawn.light.shape)
    if share == 0.0:
        return drawn
    gap = _discs(drawn.centres + _polar(inside, turn[0]), part)
    glint = _discs(drawn.centres + _polar(beyond, turn[1]), part)
    light = drawn.light * (1.0 - gap) * (lot >= share / 3.0)
    return Spots(
        np.maximum(light, glint), drawn.noise, drawn.centres, drawn.scale_px, drawn.profile
    )


def _polar(away: Floats, turn: Floats) -> Floats:
    return np.asarray(away[:, None] * np.column_stack([np.cos(turn), np.sin(turn)]))


def _discs(centres: Floats, radius: float) -> Floats:
    """Frames (N, H, W) of small discs; light at the pixel's middle is near enough for a fault."""
    from scipy.special import ndtr  # noqa: PLC0415 - SciPy where frames are drawn

    axis = np.arange(SIZE_PX)
    x = axis[None, None, :] - centres[:, 0, None, None]
    y = axis[None, :, None] - centres[:, 1, None, None]
    return np.asarray(ndtr((radius - np.hypot(x, y)) / EDGE_PX))
