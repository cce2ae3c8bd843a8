"""C54: run times of a thresholded centroid, linear phase and eigen-analysis (Enright2008b).

Batches of 100 profiles with noise of 1 % on two arrays of 64 to 512 pixels, of the same length and
under the same image; ratios are geometric means over the numbers of pixels. The conventional method
is `bctm-profile`.
"""

from __future__ import annotations

import math

from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.profiles.methods import BCTM, EIGEN, LINEAR, times_of
from benchmark.claims.experiments.profiles.slit_images import SlitImages
from benchmark.seeds import generator

PITCHES = (2.0, 1.0, 0.5, 0.25)

SKETCH = Sketch(log_x=True)


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    sizes = [SlitImages(pitch=pitch) for pitch in PITCHES]
    taken = [
        times_of(images, (BCTM, LINEAR, EIGEN), generator("claims", "C54", number, images.pixels))
        for images in sizes
    ]
    phase = [ratio(times[LINEAR], times[BCTM]) for times in taken]
    eigen = [ratio(times[EIGEN], times[BCTM]) for times in taken]
    elements = [images.pixels for images in sizes]
    each = math.prod(phase) ** (1.0 / len(phase))
    return Trial(
        {"phase": each, "eigen": ratio(math.prod(eigen) ** (1.0 / len(eigen)), each)},
        {"linear-phase": (elements, phase), "eigen-analysis": (elements, eigen)},
    )
