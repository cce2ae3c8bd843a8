"""C53: the same image on larger and on smaller pixels (Enright2008b).

The image, 0.2 mm wide with edges blurred by 0.7 design pixels (12.5 um), falls on arrays of the
same length with pixels a quarter to four times as large. The light is the same: an image gives
10,000 electrons to a pixel of the design, to others by their size, and the background 20; every
pixel is read with 10 electrons of noise, whatever its size. Errors are geometric means of
`linear-phase` and `eigen-analysis`, which both are given the pitch. The second method is the
Cramer-Rao bound of the same profiles: what the pixels still tell, whoever reads them.
"""

from __future__ import annotations

import math

import numpy as np

from algorithms.contract import Floats
from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.profiles.methods import EIGEN, LINEAR, METHODS
from benchmark.claims.experiments.profiles.slit_images import DESIGN_PITCH_MM, SlitImages, move
from benchmark.seeds import generator

PITCHES = (0.25, 0.5, 1.0, 2.0, 4.0)
IMAGE_E, BACKGROUND_E, READ_NOISE_E = 10_000.0, 20.0, 10.0
PROFILES, BOUND_PROFILES = 2400, 64
UM_PER_PX = 1000.0 * DESIGN_PITCH_MM

SKETCH = Sketch(log_x=True)


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    rng = generator("claims", "C53", number)
    places = move(PROFILES, rng)
    phase, eigen, bounds = zip(*(_errors(pitch, places, rng) for pitch in PITCHES), strict=True)
    both = [math.sqrt(one * other) for one, other in zip(phase, eigen, strict=True)]
    return Trial(
        _statistics(both),
        {
            "linear-phase": (PITCHES, phase),
            "eigen-analysis": (PITCHES, eigen),
            "Cramer-Rao bound": (PITCHES, bounds),
        },
        _statistics(list(bounds)),
    )


def _statistics(errors: list[float]) -> dict[str, float]:
    by_pitch = dict(zip(PITCHES, errors, strict=True))
    return {
        "larger": ratio(by_pitch[2.0], by_pitch[1.0]),
        "smaller": ratio(by_pitch[0.5], by_pitch[1.0]),
    }


def _errors(pitch: float, places: Floats, rng: np.random.Generator) -> tuple[float, float, float]:
    """Errors of both methods and the bound, um."""
    images = SlitImages(pitch=pitch)
    expected = pitch * (IMAGE_E * images.light(places) + BACKGROUND_E)
    profiles = rng.poisson(expected) + rng.normal(0.0, READ_NOISE_E, expected.shape)

    def variance(light_e: Floats) -> Floats:
        return np.asarray(light_e + pitch * BACKGROUND_E + READ_NOISE_E**2)

    phase, eigen = (images.error_px(METHODS[m], profiles, places) for m in (LINEAR, EIGEN))
    bound = images.bound_px(places[:BOUND_PROFILES], pitch * IMAGE_E, variance)
    return UM_PER_PX * phase, UM_PER_PX * eigen, UM_PER_PX * bound
