"""C52: eigen-analysis over the full range of noise, and what it costs (Enright2006b).

Images and noise as C51; errors are set beside the Cramer-Rao bound of the same profiles, with the
brightness and the dark level of each array unknown. Run times are those of 100 profiles with noise
of 1 %.
"""

from __future__ import annotations

from benchmark.claims.benches import ratio
from benchmark.claims.experiment import Line, Sketch, Trial
from benchmark.claims.experiments.profiles.methods import (
    EIGEN,
    METHODS,
    NOISES,
    errors_by_noise,
    times_of,
)
from benchmark.claims.experiments.profiles.slit_images import SlitImages
from benchmark.seeds import generator

SKETCH = Sketch(log_x=True)


def trial(number: int) -> Trial:
    """Measure one draw of places and noise."""
    rng = generator("claims", "C52", number)
    found, bounds = errors_by_noise(rng)
    over = {
        name: [ratio(error, bound) for error, bound in zip(errors, bounds, strict=True)]
        for name, errors in found.items()
    }
    taken = dict(times_of(SlitImages(), tuple(METHODS), rng))
    lines: dict[str, Line] = {name: (NOISES, ratios) for name, ratios in over.items()}
    eigen = taken.pop(EIGEN)
    return Trial(
        {"works": max(over[EIGEN]), "costs": ratio(eigen, max(taken.values()))},
        lines,
    )
