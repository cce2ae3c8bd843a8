"""C55: linear phase where the images of two slits overlap (Enright2007b).

Two slits of a mask, both known to the method, cast images 16 pixels wide at separations from half
a width, where they overlap by half, to three widths; where both fall it is twice as bright. Noise
is 1 % of one image's brightness. The Cramer-Rao bound of the same profiles shows that the light
tells the shift as well whether the images overlap or not. As it ships, linear phase reads each
image in a window that ends halfway to the other one.
"""

from __future__ import annotations

import numpy as np

from algorithms.contract import Floats
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.profiles.methods import EIGEN, LINEAR, METHODS
from benchmark.claims.experiments.profiles.slit_images import HALF_PX, SlitImages, move
from benchmark.seeds import generator

#: Between the middles, in widths of an image.
SEPARATIONS = (0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 3.0)
NOISE = 0.01
PROFILES, BOUND_PROFILES = 400, 32


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    rng = generator("claims", "C55", number)
    places = move(PROFILES, rng)
    phase, eigen, bounds = zip(*(_errors(s, places, rng) for s in SEPARATIONS), strict=True)
    return Trial(
        {"suffers": ratio(phase[0], phase[-1])},
        {
            "linear-phase": (SEPARATIONS, phase),
            "eigen-analysis": (SEPARATIONS, eigen),
            "Cramer-Rao bound": (SEPARATIONS, bounds),
        },
    )


def _errors(
    separation: float, places: Floats, rng: np.random.Generator
) -> tuple[float, float, float]:
    """Errors of linear phase and of eigen-analysis, and the bound, px."""
    away = HALF_PX * separation
    images = SlitImages((-away, away))
    light = images.light(places)
    profiles = light + NOISE * rng.standard_normal(light.shape)
    phase, eigen = (images.error_px(METHODS[m], profiles, places) for m in (LINEAR, EIGEN))
    bound = images.bound_px(
        places[:BOUND_PROFILES], 1.0, lambda expected: np.full_like(expected, NOISE**2)
    )
    return phase, eigen, bound
