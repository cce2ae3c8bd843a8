"""Standard data sets as experiments use them: calibrate a method, and its errors on the test split.

Experiments import the presets, extractors and models that they measure, and name none of them by
text: what an outcome depends on is then found by following imports (`benchmark.results.modules`).
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from algorithms.angles import separation_deg
from algorithms.chain import Chain, Scored
from algorithms.contract import Extractor, Floats, Model
from algorithms.pipeline import Pipeline, extract_features
from benchmark.simulator.light.memory import memory

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples

#: Takings of a run time, by turns; the shortest counts.
_TAKINGS = 7


@dataclass
class ConditionView:
    """A data set under one condition as one unit of its sensor sees it, made when first asked for.

    The preset is of unit 0, or one that an experiment altered.
    """

    preset: Preset
    condition: str = "nominal"
    unit: int = 0
    _splits: dict[str, Samples] = field(default_factory=dict, repr=False)
    _features: dict[tuple[type[Extractor], str], Floats] = field(default_factory=dict, repr=False)

    def samples(self, split: str) -> Samples:
        """Return the split ``calibration`` or ``test``."""
        if split not in self._splits:
            # units of a data set look up the same tables of light
            memory.cache_for((self.preset.name, self.unit), self.preset.name)
            unit = self.preset.for_unit(self.unit) if self.unit else self.preset
            self._splits[split] = unit.generate(self.condition, split)
        return self._splits[split]

    def features(self, extractor: type[Extractor], split: str) -> Floats:
        """Features (N, F) that an extractor finds in a split."""
        if (extractor, split) not in self._features:
            samples = self.samples(split)
            method = extractor.for_sensor(self.preset.geometry_for(self.condition))
            found = extract_features(method, samples.observations, samples.origin_px)
            self._features[extractor, split] = found
        return self._features[extractor, split]

    def calibrate(self, extractor: type[Extractor], model: Scored | Model) -> Pipeline:
        """Return the pipeline fitted to the calibration split.

        `model` is a class or a chain, made for the sensor here, or an instance made by the caller.
        """
        geometry = self.preset.geometry_for(self.condition)
        method = extractor.for_sensor(geometry)
        made = cast("Model", model)
        if isinstance(model, type | Chain):
            made = model.for_sensor(geometry, method.about.kind)
        known = self.samples("calibration")
        pipeline = Pipeline(method, made)
        pipeline.fit_features(self.features(extractor, "calibration"), known.sun, known.context)
        return pipeline

    def errors(self, extractor: type[Extractor], model: Scored | Model) -> Floats:
        """Separation angles (N,) in degrees on the test split; NaN where there is no answer."""
        return self.errors_of(self.calibrate(extractor, model), extractor)

    def errors_of(self, pipeline: Pipeline, extractor: type[Extractor]) -> Floats:
        """Separation angles (N,) of a pipeline that was calibrated, here or on other data."""
        tested = self.samples("test")
        said = pipeline.predict_features(self.features(extractor, "test"), tested.context)
        return separation(said, tested.sun)

    def incidence_deg(self, split: str = "test") -> Floats:
        """Angles (N,) of the Suns of a split from the boresight."""
        cosine = np.clip(self.samples(split).sun[:, 2], -1.0, 1.0)
        return np.asarray(np.degrees(np.arccos(cosine)))


def separation(said: ArrayLike, sun: ArrayLike) -> Floats:
    """Angles (N,) in degrees between directions (N, 3); NaN where one of them is NaN."""
    return np.asarray(separation_deg(np.asarray(said, float), np.asarray(sun, float)))


def rms(errors: ArrayLike, where: ArrayLike | None = None) -> float:
    """Root mean square of the errors that are numbers, or of those `where`; NaN for none."""
    chosen = np.asarray(errors, dtype=np.float64)
    if where is not None:
        chosen = chosen[np.asarray(where)]
    chosen = chosen[np.isfinite(chosen)]
    return math.sqrt(float(np.mean(chosen**2))) if len(chosen) else math.nan


def rms_within(errors: ArrayLike, places: Floats, edges: ArrayLike) -> list[float]:
    """`rms` between each pair of neighbouring edges."""
    inner = np.asarray(edges, dtype=np.float64)
    return [
        rms(errors, (low <= places) & (places < high)) for low, high in itertools.pairwise(inner)
    ]


def middles(edges: ArrayLike) -> list[float]:
    """Middles between neighbouring edges."""
    inner = np.asarray(edges, dtype=np.float64)
    return list((inner[:-1] + inner[1:]) / 2.0)


def ratio(over: float, under: float) -> float:
    """Return over / under; NaN where either is none or the divisor is 0."""
    return over / under if under > 0 else math.nan


def exponent(places: ArrayLike, values: ArrayLike) -> float:
    """Slope of log value against log place, by least squares; NaN with fewer than two points."""
    x, y = (np.asarray(v, dtype=np.float64) for v in (places, values))
    good = np.isfinite(x) & np.isfinite(y) & (x > 0) & (y > 0)
    if good.sum() < 2:
        return math.nan
    return float(np.polyfit(np.log(x[good]), np.log(y[good]), 1)[0])


def rank_correlation(places: ArrayLike, values: ArrayLike) -> float:
    """Spearman's correlation; NaN with fewer than three points that are numbers."""
    from scipy.stats import spearmanr  # noqa: PLC0415 - a second that few experiments need

    x, y = (np.asarray(v, dtype=np.float64) for v in (places, values))
    good = np.isfinite(x) & np.isfinite(y)
    return float(spearmanr(x[good], y[good]).statistic) if good.sum() > 2 else math.nan


def times_s(**calls: Callable[[], Any]) -> Mapping[str, float]:
    """Shortest run time of each call in seconds, taken by turns so that all see the same load."""
    for call in calls.values():
        call()  # compiled, and its data in the caches
    best = dict.fromkeys(calls, math.inf)
    for _ in range(_TAKINGS):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            best[name] = min(best[name], time.perf_counter() - start)
    return best


def draw(values: NDArray[Any], count: int, rng: np.random.Generator) -> NDArray[Any]:
    """Return `count` rows drawn without putting back, in their order."""
    return np.asarray(values[np.sort(rng.permutation(len(values))[:count])])
