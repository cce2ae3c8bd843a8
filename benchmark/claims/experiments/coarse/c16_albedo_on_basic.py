"""C16: what light from the Earth does to the basic fusion model (Allgeier2009).

Calibrated on the ground, the photodiode cube is tested on the same Suns with and without the
sunlit Earth in view; `basic` does not model the Earth. Its response is a plain cosine, as the
survey states of these equations. The plot shows beside it what albedo does where the response is
Kelly's, of which `basic` knows nothing either.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.contract import Floats
from algorithms.extractors.currents.photodiode import DirectSignals
from algorithms.models.geometric.multisensor_fusion import SixFaces
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Sketch, Trial
from benchmark.datasets.standard import pd_maskless_cube

SKETCH = Sketch(log_up=True)
_SETUPS = pd_maskless_cube.PRESET.setups
PRESET = replace(
    pd_maskless_cube.PRESET,
    setups={
        **_SETUPS,
        "cosine, albedo": replace(_SETUPS["albedo"], sensor=_SETUPS["cosine"].sensor),
    },
)

#: Shares of the samples whose errors are no larger than what is drawn.
SHARES = (0.05, 0.1, 0.25, 0.5, 0.75, 0.9, 0.95, 1.0)


def trial(number: int) -> Trial:
    """Measure one unit."""
    kelly = _errors(number, "nominal", "albedo")
    cosine = _errors(number, "cosine", "cosine, albedo")
    lines = {
        f"{earth} Earth, {response}": (SHARES, list(np.nanquantile(found, SHARES)))
        for response, both in (("Kelly response", kelly), ("cosine", cosine))
        for earth, found in zip(("black", "sunlit"), both, strict=True)
    }
    return Trial({"limited": ratio(rms(cosine[1]), rms(cosine[0]))}, lines)


def _errors(number: int, without: str, with_albedo: str) -> tuple[Floats, Floats]:
    bare, earth = (ConditionView(PRESET, condition, number) for condition in (without, with_albedo))
    calibrated = bare.calibrate(DirectSignals, SixFaces)
    return bare.errors_of(calibrated, DirectSignals), earth.errors_of(calibrated, DirectSignals)
