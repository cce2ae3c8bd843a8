"""C50: image correlation with spots missing, and with other windows (Xing2008).

Grids of 10 x 10 spots of which a share is missing, drawn anew in every frame. A window is the
template and half the correlations to each side: their number is varied about the shipped one.
Windows off centre come about by tracking: in the second of two frames they stand where the spots of
the first one were; the second frames are the same wherever the windows stand. The lines show what
the published equations make of the same frames in one pass, too: windows stay where they are put,
and the centroid is of the whole correlation.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from algorithms.extractors.frames.multi_spot.image_correlation import (
    ImageCorrelation,
    drawn_templates,
)
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.frames.single_discs import error_px
from benchmark.claims.experiments.frames.spot_grids import (
    grid_frames,
    grid_geometry,
    middles_px,
    present,
)
from benchmark.synthetic_features.light import BACKGROUND_E

SKETCH = Sketch()

SHARES = (0.0, 0.1, 0.3, 0.5, 0.7)
MISSING = 0.3
#: Correlations to both sides of a window.
WINDOWS = (2, 4, 6, 8, 10, 12, 14)
#: How far windows stand beside their spots along x, px.
CENTRES = (0.0, 0.5, 1.0, 2.0, 3.0, 4.0)
FRAMES, PAIRS = 24, 12


def trial(number: int) -> Trial:
    """Measure one draw of places, missing spots and noise."""
    method = ImageCorrelation.for_sensor(grid_geometry())
    middles = middles_px("C50", number, FRAMES)
    errors, found = [], []
    for share in SHARES:
        said = method.extract(
            grid_frames("C50", number, middles, present("C50", number, FRAMES, share))
        )
        errors.append(error_px(said, middles))
        found.append(1.0 - float(np.isnan(said).any(axis=1).mean()))
    at = SHARES.index(MISSING)
    whole = grid_frames("C50", number, middles, present("C50", number, FRAMES, 0.0))
    windows = [error_px(replace(method, correlations=n).extract(whole), middles) for n in WINDOWS]
    last, places = whole[:PAIRS], middles[:PAIRS]
    centres = [
        error_px(_track(number, method, last, places - [away, 0.0]), places) for away in CENTRES
    ]
    printed = [
        error_px(_print_text(method, last, places - [away, 0.0]), places) for away in CENTRES
    ]
    values = {
        "survives": ratio(errors[at], errors[0]),
        "found": found[at],
        "window": ratio(max(windows), min(windows)),
        "centre": ratio(max(centres), min(centres)),
    }
    lines = {
        "missing spots": (SHARES, errors),
        "across: correlations / 20": (tuple(n / 20.0 for n in WINDOWS), windows),
        "across: window off centre, px / 10": (tuple(c / 10.0 for c in CENTRES), centres),
        "the same as printed": (tuple(c / 10.0 for c in CENTRES), printed),
    }
    return Trial(values, lines)


def _track(
    number: int, method: ImageCorrelation, frames: NDArray[Any], predicted: Floats
) -> Floats:
    """Answers (N, 2) to frames whose windows stand where a frame before had its spots."""
    before = grid_frames(
        "C50", number, predicted, present("C50", number, len(frames), 0.0), "before"
    )
    pairs = np.stack([before, frames], axis=1)
    return np.array([method.track(pair)[1] for pair in pairs])


def _print_text(method: ImageCorrelation, frames: NDArray[Any], predicted: Floats) -> Floats:
    """``Dx + sum C_s (m - N_c / 2) / sum C_s`` with windows at ``int(Dx + x_s + 0.5)``."""
    apertures = np.array(method.apertures_px)
    template = drawn_templates((float(apertures[0, 2]),), method.blur_px, square=False)[0]
    lags, reach = method.correlations, method.correlations // 2 + len(template) // 2
    found = np.empty((len(frames), 2))
    for k, frame in enumerate(frames):
        total = np.zeros((lags + 1, lags + 1))
        for x, y in np.floor(predicted[k] + apertures[:, :2] + 0.5).astype(int):
            window = frame[y - reach : y + reach + 1, x - reach : x + reach + 1] - BACKGROUND_E
            views = np.lib.stride_tricks.sliding_window_view(window, template.shape)
            total += np.einsum("mnij,ij->mn", views, template)
        steps = np.arange(lags + 1) - lags / 2.0
        moved = np.array([total.sum(axis=0) @ steps, total.sum(axis=1) @ steps]) / total.sum()
        found[k] = predicted[k] + moved
    return found
