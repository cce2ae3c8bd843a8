"""C51: linear phase beside thresholded centroid, peak and eigen-analysis (Enright2007b).

A slit's image 16 pixels wide falls on two arrays of 128 pixels, anywhere within 20 pixels of the
middle; normal noise of the same size is added to every pixel. All four methods read the same
profiles. How fast a method degrades is its error under noise of 20 % of the image's brightness over
that under 0.5 %.
"""

from __future__ import annotations

from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Line, Sketch, Trial
from benchmark.claims.experiments.profiles.methods import (
    BCTM,
    EIGEN,
    LINEAR,
    NOISES,
    PD,
    errors_by_noise,
)
from benchmark.seeds import generator

LOW, HIGH = NOISES.index(0.005), NOISES.index(0.2)

SKETCH = Sketch(log_x=True)


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    found, bounds = errors_by_noise(generator("claims", "C51", number))
    growth = {name: ratio(errors[HIGH], errors[LOW]) for name, errors in found.items()}
    lines: dict[str, Line] = {name: (NOISES, errors) for name, errors in found.items()}
    return Trial(
        {
            "bctm": ratio(found[BCTM][LOW], found[LINEAR][LOW]),
            "pd": ratio(found[PD][LOW], found[LINEAR][LOW]),
            "faster-bctm": ratio(growth[LINEAR], growth[BCTM]),
            "faster-eigen": ratio(growth[LINEAR], growth[EIGEN]),
        },
        {**lines, "Cramer-Rao bound": (NOISES, bounds)},
    )
