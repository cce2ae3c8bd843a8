"""C11: what knowing of the gap between the quadrants is worth, as it widens (Faizullin2017).

Each gap is calibrated twice with the model `qpd`: with the gap as drawn (of a round spot it is
then fitted), and with none at all. All else is fitted alike. Faizullin2017's aperture is round,
and the statistic is of a round one. The plot shows the data set's nominal square one beside it,
where the gap changes the balance's scale and nothing else, which the focal length's fit takes up.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.geometric.quadrant_gap import QuadrantGap
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.claims.experiments.geometry.partly_fixed import PartlyFixedModel
from benchmark.datasets.standard import qpd_single_aperture

#: The nominal gap, mm, and that of the condition ``wide-gap``.
NOMINAL, WIDE = 0.05, 0.2
GAPS_MM = (0.0, 0.025, NOMINAL, 0.1, 0.15, WIDE)
SHAPES = {"square": "nominal", "round": "round-aperture"}
SKETCH = Sketch()


def trial(number: int) -> Trial:
    """Measure one unit with each gap behind both apertures."""
    lines, by_gap = {}, {}
    for shape, condition in SHAPES.items():
        errors = [_errors(gap, condition, number) for gap in GAPS_MM]
        without, with_it = zip(*errors, strict=True)
        lines[f"{shape}, without"] = (GAPS_MM, without)
        lines[f"{shape}, with"] = (GAPS_MM, with_it)
        by_gap = {gap: ratio(*both) for gap, both in zip(GAPS_MM, errors, strict=True)}
    # the round aperture's, which is the last
    values = {"reduces": by_gap[NOMINAL], "wider": ratio(by_gap[WIDE], by_gap[NOMINAL])}
    return Trial(values, lines)


def _errors(gap_mm: float, condition: str, unit: int) -> tuple[float, float]:
    """RMS errors without the gap in the model and with it."""
    preset = qpd_single_aperture.PRESET
    drawn = replace(preset.geometry_for(condition), gap_mm=gap_mm)
    wide = alter(preset, partial(_apart, gap_mm=gap_mm), drawn, condition)
    seen = ConditionView(wide, condition, unit)
    kind = VoltageBalance.about.kind
    gapless = QuadrantGap.for_sensor(replace(drawn, gap_mm=0.0), kind)
    others = tuple(one.name for one in gapless.free_parameters() if one.name != "gap")
    return (
        rms(seen.errors(VoltageBalance, PartlyFixedModel(gapless, others))),
        rms(seen.errors(VoltageBalance, QuadrantGap.for_sensor(drawn, kind))),
    )


def _apart(sensor: Any, gap_mm: float) -> Any:
    return replace(sensor, detector=replace(sensor.detector, gap_mm=gap_mm))
