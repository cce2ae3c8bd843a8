"""One pipeline's own error, measured again with one part of the chain made perfect at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline
from algorithms.references import ReferenceCorrection
from algorithms.threads import one_thread
from benchmark.datasets.benches import report
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.datasets.preset import Preset
from benchmark.datasets.samples import Samples
from benchmark.error_budget import perfected
from benchmark.error_budget.variants import VARIANTS
from benchmark.metrics.separation import separation_deg
from benchmark.running.fitting import BENCHES
from benchmark.simulator.light.memory import memory

#: Input of a calibration: features, Suns, context.
_CalibrationData = tuple[Floats, Floats, Mapping[str, NDArray[Any]] | None]


@dataclass(frozen=True)
class VariantErrors:
    """Errors of one pipeline on one data set, root mean square in degrees.

    By variant (`VARIANTS`); None where there is nothing of the kind, or the model refuses the
    calibration. All over the same `judged` samples: observable ones that every variant answers.
    """

    errors_deg: Mapping[str, float | None]
    judged: int


def score_variants(
    preset: Preset,
    condition: str,
    extractor: type[Extractor],
    model: Scored,
    *,
    all_observable: bool = False,
) -> VariantErrors:
    """Score a pipeline as it is, with parts of the chain made perfect, and with two made worse.

    As it is, the calibration has the true directions of its poses, and readings are corrected by
    the unit's references.

    Notes
    -----
    - ``bench``: the calibration has the directions that `BENCHES` drawn benches give, pooled.
    - ``uncorrected``: readings are not corrected by the unit's references.
    - ``lamp``: its lamp shines evenly and steadily, the Sun's mean light.
    - ``calibration_noise``, ``noise``: readings of the calibration, or of the test poses, are
      medians, under mean stray light (`perfected.still_observations`).
    - ``references``: readings are corrected by the unit's true dark signals and gains.
    - ``fixed_pattern``: of a unit whose elements are alike.
    - ``surroundings``: no light from the Earth, no drift, no ageing.
    - ``perfect``: all of these. What error is left is the extractor's and the model's.
    - ``perfect_dense``: the same, fitted to the test poses beside the calibration's: no pose is
      far from a known one.
    - ``places``, ``places_dense``: as the two before, with the spots' true places in the place of
      the extractor's features.
    """
    with one_thread():
        memory.cache_for((preset.name, 0), preset.name)
        errors = _Chain(preset, condition, extractor, model).errors()
        seen = np.ones(len(errors["as_is"]), dtype=np.bool_)
        if not all_observable:
            seen &= np.asarray(preset.bound(condition, "test").observable)
        return _judged(errors, seen)


def directions(
    preset: Preset, condition: str, extractor: type[Extractor], model: Scored
) -> tuple[Floats, dict[str, Floats]]:
    """Return true directions (N, 3) of a test split, and a pipeline's ``as_is`` and ``perfect``.

    Parameters as `score_variants`; answers as its variants of these names, NaN rows where there is
    none. A variant is left out where the model refuses its calibration.
    """
    with one_thread():
        memory.cache_for((preset.name, 0), preset.name)
        chain = _Chain(preset, condition, extractor, model)
        answers = {**chain.as_is(), **chain.perfect()}
        shown = {name: answers[name] for name in ("as_is", "perfect")}
        given = {name: found for name, found in shown.items() if found is not None}
        return chain.test.truth, given


class _Chain:
    """A pipeline with the samples of both splits, and what is found in them as it is."""

    def __init__(
        self, preset: Preset, condition: str, extractor: type[Extractor], model: Scored
    ) -> None:
        self._preset, self._condition = preset, condition
        self._geometry = preset.geometry_for(condition)
        self._extractor = extractor.for_sensor(self._geometry)
        self._model = model
        self._by = correction(preset, condition)
        self.calibration, self.test = (preset.generate(condition, split) for split in _SPLITS)
        self._told, self._asked = (
            self._seen(samples, self._by) for samples in (self.calibration, self.test)
        )

    def errors(self) -> dict[str, Floats]:
        """Errors (N,) by variant, degrees; NaN where there is no answer.

        UnusableDataError where the model refuses the calibration as it is.
        """
        answers = self.as_is()
        if answers["as_is"] is None:
            raise UnusableDataError("the model refuses the calibration as it is")
        answers |= {**self._readings(), **self._units(), **self.perfect()}
        errors = {
            name: separation_deg(given, self.test.truth)
            for name, given in answers.items()
            if given is not None
        }
        on_benches = [given for given in self._on_benches() if given is not None]
        if len(on_benches) == BENCHES:
            each = [separation_deg(given, self.test.truth) for given in on_benches]
            errors["bench"] = np.sqrt(np.mean(np.square(each), axis=0))
        return errors

    def as_is(self) -> dict[str, Floats | None]:
        """Answers of the chain as it is."""
        return {"as_is": self._answers([self._told], self._asked)}

    def _on_benches(self) -> list[Floats | None]:
        """Answers of calibrations with the directions that drawn benches give."""
        found, truth, context = self._told
        drawn = (report(self._preset, self._condition, truth, draw) for draw in range(BENCHES))
        return [self._answers([(found, sun, context)], self._asked) for sun in drawn]

    def _readings(self) -> dict[str, Floats | None]:
        """Answers with other readings of the same unit: still, evenly lit, corrected otherwise."""
        preset, condition = self._preset, self._condition
        still_told = self._seen(self._still(preset, self.calibration, "calibration"), self._by)
        still_asked = self._seen(self._still(preset, self.test, "test"), self._by)
        answers = {
            "calibration_noise": self._answers([still_told], self._asked),
            "noise": self._answers([self._told], still_asked),
        }
        if self._by is not None:
            known = perfected.known_unit(preset, condition)
            for name, by in (("references", known), ("uncorrected", None)):
                calibration, asked = self._seen(self.calibration, by), self._seen(self.test, by)
                answers[name] = self._answers([calibration], asked)
        lit = perfected.without_lamp_errors(preset, condition)
        if lit is not None:
            calibration = self._seen(lit.generate(condition, "calibration"), self._by)
            answers["lamp"] = self._answers([calibration], self._asked)
        return answers

    def _units(self) -> dict[str, Floats | None]:
        """Answers of other units, or elsewhere."""
        condition, answers = self._condition, {}
        others = {
            "fixed_pattern": perfected.without_fixed_pattern(self._preset, condition),
            "surroundings": perfected.without_surroundings(self._preset, condition),
        }
        for name, other in others.items():
            if other is not None:
                by = correction(other, condition)
                calibration, asked = (self._seen(other.generate(condition, s), by) for s in _SPLITS)
                answers[name] = self._answers([calibration], asked)
        return answers

    def perfect(self) -> dict[str, Floats | None]:
        """Answers of the chain of which only extractor and model are what they are."""
        preset, kind = perfected.perfect(self._preset, self._condition), self._extractor.about.kind
        by = perfected.known_unit(preset, self._condition)
        calibration, asked = (
            self._seen(self._still(preset, samples, split), by)
            for samples, split in zip((self.calibration, self.test), _SPLITS, strict=True)
        )
        more = self._seen(self._still(preset, self.test, "test", before_lamp=True), by)
        answers = {
            "perfect": self._answers([calibration], asked),
            "perfect_dense": self._answers([calibration, more], asked),
        }
        known = [
            (perfected.true_features(preset, self._condition, kind, sun, found), sun, context)
            for found, sun, context in (calibration, asked)
        ]
        true = [(places, sun, context) for places, sun, context in known if places is not None]
        if len(true) == len(known):
            answers["places"] = self._answers(true[:1], true[1])
            answers["places_dense"] = self._answers(true, true[1])
        return answers

    def _still(
        self, preset: Preset, samples: Samples, split: str, *, before_lamp: bool = False
    ) -> Samples:
        """Return the samples as they would be read without noise, and what is known beside."""
        condition = self._condition
        read = perfected.still_observations(preset, condition, split, before_lamp=before_lamp)
        context = getattr(preset, "context", None)
        beside = samples.context if context is None else context(self._condition, split)
        return replace(samples, observations=read, context=beside)

    def _seen(self, samples: Samples, by: ReferenceCorrection | None) -> _CalibrationData:
        return features_of(self._extractor, samples, by), samples.truth, samples.context

    def _answers(self, known: Sequence[_CalibrationData], asked: _CalibrationData) -> Floats | None:
        """Return directions (N, 3) by a model fitted to all that is known; None if it refuses."""
        model = self._model.for_sensor(self._geometry, self._extractor.about.kind)
        pipeline = Pipeline(self._extractor, model)
        features, sun = (np.concatenate([one[k] for one in known]) for k in (0, 1))
        contexts = [one[2] for one in known if one[2] is not None]
        columns = contexts[0] if contexts else {}
        context = {name: np.concatenate([one[name] for one in contexts]) for name in columns}
        try:
            pipeline.fit_features(features, sun, context or None)
        except UnusableDataError:
            return None
        return pipeline.predict_features(asked[0], asked[2])


_SPLITS = ("calibration", "test")


def _judged(errors: Mapping[str, Floats], observable: NDArray[np.bool_]) -> VariantErrors:
    judged = np.logical_and.reduce([observable, *map(np.isfinite, errors.values())])
    pooled = {name: float(np.sqrt(np.mean(error[judged] ** 2))) for name, error in errors.items()}
    return VariantErrors({name: pooled.get(name) for name in VARIANTS}, int(judged.sum()))
