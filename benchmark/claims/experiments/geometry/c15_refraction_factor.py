"""C15: what one scale factor K does against refraction, for the N of slits (Maji2015).

Under cover glass `n-slit` is calibrated with K held at 1 and with K fitted; the line's place and
turns are fitted both times. As the equations are printed K stands for refraction alone, and
neither fit includes the glass. The plot also shows the model that includes the glass and applies
Snell's law; no statistic uses it.
"""

from __future__ import annotations

from dataclasses import replace

from algorithms.extractors.profiles.eigen_analysis import EigenAnalysis
from algorithms.models.geometric.n_slit import NSlit
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.partly_fixed import PartlyFixedModel
from benchmark.datasets.standard import pda_n_slit

EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 62.0)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(pda_n_slit.PRESET, "glass", number)
    incidence, kind = seen.incidence_deg(), EigenAnalysis.about.kind
    glass = seen.preset.geometry_for("glass")
    printed = NSlit.for_sensor(replace(glass, cover_glass=None), kind)
    others = tuple(one.name for one in printed.free_parameters() if one.name != "K")
    errors = {
        "K = 1": seen.errors(EigenAnalysis, PartlyFixedModel(printed, others)),
        "K fitted": seen.errors(EigenAnalysis, printed),
        "K and Snell's law": seen.errors(EigenAnalysis, NSlit.for_sensor(glass, kind)),
    }
    lines = {
        name: (middles(EDGES_DEG), rms_within(found, incidence, EDGES_DEG))
        for name, found in errors.items()
    }
    corrects = ratio(rms(errors["K = 1"]), rms(errors["K fitted"]))
    return Trial({"corrects": corrects}, lines)
