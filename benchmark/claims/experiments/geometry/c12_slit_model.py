"""C12: what the slit model corrects of a misassembled slit sensor (KeQiang2020).

Both sensors stand as their condition ``misaligned`` has them: slits deflected, inclined and too
high, the head tilted. `slit` is calibrated there; `spm` knows the drawing alone. Both read the same
spots, by the extractor that leads on both boards. The statistic is the geometric mean of both
sensors' ratios.
"""

from __future__ import annotations

import math

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.models.geometric.single_slit import DeflectedSlits
from algorithms.models.geometric.standard_projection import StandardProjection
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.datasets.standard import ccd_slit, pda_slit

EDGES_DEG = (0.0, 15.0, 25.0, 35.0, 45.0, 55.0, 70.0)


def trial(number: int) -> Trial:
    """Measure one unit of both sensors."""
    ratios, lines = [], {}
    for module in (ccd_slit, pda_slit):
        seen = ConditionView(module.PRESET, "misaligned", number)
        incidence = seen.incidence_deg()
        errors = {m: seen.errors(EigenAnalysis, m) for m in (StandardProjection, DeflectedSlits)}
        ratios.append(ratio(*(rms(found) for found in errors.values())))
        for model, found in errors.items():
            within = rms_within(found, incidence, EDGES_DEG)
            lines[f"{module.PRESET.name}, {model.about.name}"] = (middles(EDGES_DEG), within)
    return Trial({"reduces": math.sqrt(math.prod(ratios))}, lines)
