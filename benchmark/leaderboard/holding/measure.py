"""One pipeline scored again and again, one part of the chain made perfect at a time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.pipeline import Pipeline, extracted
from benchmark.datasets.preset import Preset
from benchmark.datasets.samples import Samples
from benchmark.leaderboard.holding import perfected
from benchmark.metrics.score import separation_deg
from benchmark.running.threads import one_thread
from benchmark.simulator.light.memory import memory

#: What is made perfect by itself, all else as it is.
SINGLE = ("reference", "lamp", "calibration_noise", "noise", "fixed_pattern", "surroundings")
#: All of that perfect; then fitted to the test poses as well; the same of the true places.
JOINT = ("perfect", "perfect_dense", "places", "places_dense")
#: Everything that is scored.
VARIANTS = ("as_is", *SINGLE, *JOINT)

#: What a calibration is told: features, Suns, context.
_Told = tuple[Floats, Floats, Mapping[str, NDArray[Any]] | None]


@dataclass(frozen=True)
class Held:
    """Errors of one pipeline on one data set, root mean square in degrees.

    Attributes
    ----------
    errors_deg
        By variant (`VARIANTS`); None where there is nothing of the kind, or the model refuses the
        calibration. All over the same samples: observable ones that every variant answers.
    judged
        How many these are.
    """

    errors_deg: Mapping[str, float | None]
    judged: int


def held(
    preset: Preset,
    condition: str,
    extractor: type[Extractor],
    model: Scored,
    *,
    all_observable: bool = False,
) -> Held:
    """Score a pipeline on a data set as it is and with parts of the chain made perfect.

    Parameters
    ----------
    preset
        Of unit 0.
    condition
        Of the data set.
    extractor, model
        Of the pipeline, as they are planned.
    all_observable
        Whether every test sample is known to be, so that no bound is needed.

    Raises
    ------
    UnusableDataError
        Where the model refuses the calibration as it is.

    Notes
    -----
    - ``reference``: the calibration is told the true directions of the same readings.
    - ``lamp``: its lamp shines evenly and steadily, the Sun's mean light.
    - ``calibration_noise``, ``noise``: readings of the calibration, or of the test poses, are
      medians, under mean stray light (`perfected.still_observations`).
    - ``fixed_pattern``: of a unit whose elements are alike.
    - ``surroundings``: no light from the Earth, no drift, no ageing.
    - ``perfect``: all of these. What error is left is the extractor's and the model's.
    - ``perfect_dense``: the same, fitted to the test poses beside the calibration's: no pose is
      far from a known one.
    - ``places``, ``places_dense``: as the two before, with the spots' true places in the place of
      the extractor's features.
    """
    with one_thread():
        memory.remember((preset.name, 0), preset.name)
        answers, sun = _Chain(preset, condition, extractor, model).answers()
        seen = np.ones(len(sun), dtype=np.bool_)
        if not all_observable:
            seen &= np.asarray(preset.bound(condition, "test").observable)
        return _judged(answers, sun, seen)


def directions(
    preset: Preset, condition: str, extractor: type[Extractor], model: Scored
) -> tuple[Floats, dict[str, Floats]]:
    """Return true directions (N, 3) of a test split, and a pipeline's ``as_is`` and ``perfect``.

    Parameters as `held`; answers as its variants of these names, NaN rows where there is none. A
    variant is left out where the model refuses its calibration.
    """
    with one_thread():
        memory.remember((preset.name, 0), preset.name)
        chain = _Chain(preset, condition, extractor, model)
        calibration, test = chain.samples()
        answers = chain.perfect(calibration, test) | chain.as_is(calibration, test)
        shown = {name: answers[name] for name in ("as_is", "perfect")}
        return test.truth, {name: given for name, given in shown.items() if given is not None}


class _Chain:
    def __init__(
        self, preset: Preset, condition: str, extractor: type[Extractor], model: Scored
    ) -> None:
        self._preset, self._condition = preset, condition
        self._geometry = preset.geometry_for(condition)
        self._extractor = extractor.for_sensor(self._geometry)
        self._model = model

    def samples(self) -> tuple[Samples, Samples]:
        """Calibration and test split as they are."""
        calibration, test = (self._preset.generate(self._condition, split) for split in _SPLITS)
        return calibration, test

    def answers(self) -> tuple[dict[str, Floats | None], Floats]:
        """Directions (N, 3) by variant, and the true ones."""
        calibration, test = self.samples()
        answers = self.as_is(calibration, test)
        told, asked = self._told(calibration), self._told(test)
        still_told = self._told(self._still(self._preset, calibration, "calibration"))
        still_asked = self._told(self._still(self._preset, test, "test"))
        answers |= {
            "reference": self._answers([(told[0], calibration.truth, told[2])], asked),
            "calibration_noise": self._answers([still_told], asked),
            "noise": self._answers([told], still_asked),
        }
        lit = perfected.without_lamp_errors(self._preset, self._condition)
        if lit is not None:
            seen = self._told(lit.generate(self._condition, "calibration"))
            answers["lamp"] = self._answers([seen], asked)
        others = {
            "fixed_pattern": perfected.without_fixed_pattern(self._preset, self._condition),
            "surroundings": perfected.without_surroundings(self._preset, self._condition),
        }
        for name, other in others.items():
            if other is not None:
                both = [self._told(other.generate(self._condition, s)) for s in _SPLITS]
                answers[name] = self._answers([both[0]], both[1])
        answers |= self.perfect(calibration, test)
        return answers, test.truth

    def as_is(self, calibration: Samples, test: Samples) -> dict[str, Floats | None]:
        """Answers of the chain as it is."""
        return {"as_is": self._answers([self._told(calibration)], self._told(test))}

    def perfect(self, calibration: Samples, test: Samples) -> dict[str, Floats | None]:
        """Answers of the chain of which only extractor and model are what they are."""
        preset, kind = perfected.perfect(self._preset, self._condition), self._extractor.about.kind
        told, asked = (
            self._told(self._still(preset, replace(samples, sun=samples.truth), split))
            for samples, split in zip((calibration, test), _SPLITS, strict=True)
        )
        more = self._told(self._still(preset, test, "test", before_lamp=True))
        answers = {
            "perfect": self._answers([told], asked),
            "perfect_dense": self._answers([told, more], asked),
        }
        found = [
            perfected.true_places(preset, self._condition, kind, one.truth)
            for one in (calibration, test)
        ]
        if found[0] is None or found[1] is None:
            return answers
        known = _as_found(found[0], told), _as_found(found[1], asked)
        answers["places"] = self._answers([known[0]], known[1])
        answers["places_dense"] = self._answers([*known], known[1])
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

    def _told(self, samples: Samples) -> _Told:
        found = extracted(self._extractor, samples.observations, samples.origin_px)
        return found, samples.sun, samples.context

    def _answers(self, known: Sequence[_Told], asked: _Told) -> Floats | None:
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


def _as_found(places: Floats, told: _Told) -> _Told:
    """Return true places with what is known beside, nothing where the extractor finds nothing."""
    there = np.isfinite(told[0]).all(axis=1, keepdims=True)
    return np.where(there, places, np.nan), told[1], told[2]


def _judged(
    answers: Mapping[str, Floats | None], sun: Floats, observable: NDArray[np.bool_]
) -> Held:
    if answers["as_is"] is None:
        raise UnusableDataError("the model refuses the calibration as it is")
    known = {name: given for name, given in answers.items() if given is not None}
    judged = np.logical_and.reduce([np.isfinite(a).all(axis=1) for a in known.values()])
    judged &= observable
    errors = {
        name: float(np.sqrt(np.mean(separation_deg(given[judged], sun[judged]) ** 2)))
        for name, given in known.items()
    }
    return Held({name: errors.get(name) for name in VARIANTS}, int(judged.sum()))
