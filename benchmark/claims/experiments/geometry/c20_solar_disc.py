"""C20: how far the Sun's disc moves a spot's centre from where a point's falls (Antonello2018).

The sensor has the study's own pinhole and height. The same Suns, window for window, light it as the
disc that they are and as points. How much farther out the extractor finds the disc's spot, in the
mean over the field, is the bias; what is left of it behind `solar-disc` is compared. Compensation
and claim are about the spot's outline: statistics are of `mt-acm`, which takes the middle between
the flanks. The plot shows a centroid, `bctm`, beside it.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from algorithms.compensations.environment.solar_disc import SolarDiscBias
from algorithms.contract import Extractor, Floats
from algorithms.extractors.frames.centroid import ThresholdedCentroid
from algorithms.extractors.frames.threshold_average import MultipleThresholdCentroid
from benchmark.claims.benches import ConditionView, middles, ratio
from benchmark.claims.experiment import Sketch, Trial
from benchmark.claims.experiments.geometry.alterations import alter
from benchmark.datasets.standard import cmos_single_aperture_pinhole

EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0)
SKETCH = Sketch(log_up=False)


def trial(number: int) -> Trial:
    """Measure one unit."""
    disc = ConditionView(cmos_single_aperture_pinhole.PRESET, unit=number)
    point = ConditionView(alter(cmos_single_aperture_pinhole.PRESET, _point), unit=number)
    incidence, lines = disc.incidence_deg(), {}
    bias = {}
    for extractor in (MultipleThresholdCentroid, ThresholdedCentroid):
        without, with_it = _shifts(disc, point, extractor)
        name = extractor.about.name
        bias[name] = abs(float(np.nanmean(without))), abs(float(np.nanmean(with_it)))
        for what, shift in (("", without), (", compensated", with_it)):
            lines[f"{name}{what}"] = (middles(EDGES_DEG), _within(shift, incidence))
    biased, left = bias["mt-acm"]
    return Trial({"biased": biased, "removed": ratio(biased, left)}, lines)


def _shifts(
    disc: ConditionView, point: ConditionView, extractor: type[Extractor]
) -> tuple[Floats, Floats]:
    """(N,) px outwards from the point's spot to the disc's, as found and compensated."""
    geometry = disc.preset.geometry
    found, parallel = disc.features(extractor, "test"), point.features(extractor, "test")
    compensation = SolarDiscBias.for_sensor(geometry, extractor.about.kind)
    compensated = compensation.fit(found, disc.samples("test").sun).transform(found)
    out = parallel - np.asarray(geometry.centre_px)
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    return ((found - parallel) * out).sum(axis=1), ((compensated - parallel) * out).sum(axis=1)


def _within(shift: Floats, incidence: Floats) -> list[float]:
    """Mean shift between neighbouring edges."""
    rings = [(low <= incidence) & (incidence < high) for low, high in pairwise(EDGES_DEG)]
    return [float(np.nanmean(shift[ring])) for ring in rings]


def _point(sensor: Any) -> Any:
    """Return the sensor in parallel light."""
    camera = sensor.camera
    return replace(sensor, camera=replace(camera, sun=replace(camera.sun, diameter_deg=0.0)))
