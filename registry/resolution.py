"""From a study to what is scored of it: its pipelines, and a reason for everything that is not.

What can be scored is the plan's to say (`registry.taxonomy`): a pipeline is announced only where it
has a cell. What is decided here, because the mapping does not say it:

- The mapping gives a study's values, not which belong together; every combination of them that
  is planned is a pipeline. A value that fits nowhere is a gap, a combination that does not is not.
- The sensor is the study's own; an empty cell is filled by a rule (`registry.sensors`).
- Methods are the study's own with its compensations as stages, or the nearest (`registry.fitting`).
- Every value of a pipeline has a basis. What is not stated is ``assumed``, with the rule that put
  it there: its score is not the study's own.
- A study is shown under what it is run for (`registry.fidelity.purposes`). Where its own sensor
  does not show that, it stands on the nearest that does, if it is nearer to the study so.
- A study whose sensor is simulated for it alone runs there and nowhere else.
- How near its run is to the study is graded (`registry.fidelity.grading`), by what is known of its
  sensor, calibration and accuracy too (`registry.fidelity.evidence`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Literal

from registry import catalogue as implementations
from registry import studies as registered
from registry.catalogue import Catalogue
from registry.fidelity import evidence
from registry.fidelity.evidence import Scores
from registry.fidelity.gaps import (
    architecture_gaps,
    empty_cells,
    method_gaps,
    nearest_gaps,
)
from registry.fidelity.grading import Fidelity, fidelity, graded
from registry.fidelity.particulars import Purpose
from registry.fidelity.purposes import PURPOSES, DataSet, DatasetCondition, purposes, settings
from registry.fidelity.runnable import Gap, RunnablePipeline, strongest
from registry.fitting import ChosenMethod, FittedPipeline, PipelinesOfStudy
from registry.sensors import BASES, SENSOR, Basis, Part, Sensor, cell, own_sensors, sensors
from registry.studies import Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Architecture, Plan

State = Literal["complete", "partial", "none"]


@dataclass(frozen=True)
class Resolution:
    """What is scored of a study.

    ``fidelity`` grades how near its run is to the study. ``state`` says whether gaps are left:
    complete (every value of its mapping runs), partial (something of it does, or what stands
    nearest to it) or none.
    """

    study: str
    fidelity: Fidelity
    state: State
    pipelines: tuple[RunnablePipeline, ...]
    gaps: tuple[Gap, ...]
    leading: tuple[RunnablePipeline, ...] = ()

    @property
    def best_pipeline(self) -> RunnablePipeline | None:
        """The pipeline that rests on most: the first of those whose weakest part is strongest."""
        return next(iter(self.strongest_pipelines), None)

    @property
    def strongest_pipelines(self) -> Sequence[RunnablePipeline]:
        """The pipelines whose first settings the study is judged by.

        Of those whose methods it does not only compare, on a sensor that differs least from its own
        and best is made after it, those that rest on most.
        """
        return self.leading or strongest(self.pipelines)

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer."""
        return {
            "key": self.study,
            **self.fidelity.to_dict(),
            "state": self.state,
            "pipelines": [pipeline.to_dict() for pipeline in self.pipelines],
            "gaps": [gap.to_dict() for gap in self.gaps],
        }


def resolve(
    study: Study | str,
    plan: Plan,
    *,
    own: Mapping[str, Plan] | None = None,
    data_sets: Mapping[str, DataSet] | None = None,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
    scores: Scores | None = None,
) -> Resolution:
    """Every pipeline of a study that is planned, and every gap.

    Parameters
    ----------
    study : Study or str
        A study or its key; InvalidValueError for an unknown key.
    plan : Plan
        What can be scored, as `benchmark.plan.combinations.scorable_plan` gives it.
    own : optional
        What can be scored on sensors of single studies, by study, as
        `benchmark.plan.combinations.study_plans` gives it; none by default.
    data_sets : optional
        What the plan's data sets show, as `benchmark.plan.shown.data_sets` gives it; one that is
        missing shows its nominal condition alone.
    catalogue, facts : optional
        What is implemented and the studies; ours and the survey's by default.
    scores : optional
        Own errors measured here, for its grade; without them no score is asked for.
    """
    known = facts or registered.facts()
    found = known.study(study) if isinstance(study, str) else study
    fitting = PipelinesOfStudy(plan, catalogue or implementations.catalogue(), known)
    return _resolve(found, fitting.on_own((own or {}).get(found.key)), data_sets or {}, scores)


def resolve_all(
    plan: Plan,
    *,
    own: Mapping[str, Plan] | None = None,
    data_sets: Mapping[str, DataSet] | None = None,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
    scores: Scores | None = None,
) -> dict[str, Resolution]:
    """`resolve` of every study, by key."""
    known = facts or registered.facts()
    fitting = PipelinesOfStudy(plan, catalogue or implementations.catalogue(), known)
    sets, owned = data_sets or {}, own or {}
    return {
        key: _resolve(one, fitting.on_own(owned.get(key)), sets, scores)
        for key, one in known.studies.items()
    }


def resolve_later(
    plan: Plan,
    survey: Facts,
    every: Facts,
    *,
    data_sets: Mapping[str, DataSet] | None = None,
    catalogue: Catalogue | None = None,
    scores: Scores | None = None,
) -> dict[str, Resolution]:
    """`resolve` of studies that the survey does not map, by key; their relatives are its own."""
    later = (study for key, study in every.studies.items() if key not in survey.studies)
    fitting = PipelinesOfStudy(plan, catalogue or implementations.catalogue(), survey)
    return {study.key: _resolve(study, fitting, data_sets or {}, scores) for study in later}


def _resolve(
    study: Study,
    fitting: PipelinesOfStudy,
    data_sets: Mapping[str, DataSet],
    scores: Scores | None,
) -> Resolution:
    found, ran = _place(study, fitting, data_sets)
    if not found.pipelines:
        return found
    facts, wanted = fitting.facts, found.fidelity.purposes
    leading = _leading(study, facts, found.pipelines, data_sets)
    methods = found.fidelity.departures
    missing = any(one.part == "model" and not one.unknown for one in methods)
    departures = (
        *evidence.identity(study),
        *evidence.sensor(study, facts, leading, data_sets),
        *evidence.parts(study, facts),
        *methods,
        # of a model that does not run its calibration is no second difference
        *(
            ()
            if missing
            else evidence.calibration(study, facts, leading, data_sets, fitting.catalogue)
        ),
        *(() if scores is None else evidence.score(study, facts, leading, scores)),
    )
    pipelines = found.pipelines
    grade = graded(
        *(study, facts, departures, wanted), pipelines=pipelines, leading=leading, ran=ran
    )
    return replace(found, fidelity=grade, leading=tuple(leading))


def _leading(
    study: Study,
    facts: Facts,
    pipelines: Sequence[RunnablePipeline],
    data_sets: Mapping[str, DataSet],
) -> Sequence[RunnablePipeline]:
    """Return the pipelines that a study is judged by: see `Resolution.strongest_pipelines`."""

    def differs(one: RunnablePipeline) -> tuple[int, bool]:
        at = data_sets.get(one.settings[0].dataset, DataSet(one.settings[0].dataset))
        others = evidence.differing(study, facts, at, (one.detector, one.mask))
        return len(others), study.key not in at.follows

    own = [
        one
        for one in pipelines
        if study.role("extractor", one.extractor_taxonomy) != "compared"
        and study.role("model", one.model_taxonomy) != "compared"
    ]
    numbers = {one: differs(one) for one in own or pipelines}
    least = min(numbers.values())
    return strongest([one for one, number in numbers.items() if number == least])


def _place(
    study: Study, fitting: PipelinesOfStudy, data_sets: Mapping[str, DataSet]
) -> tuple[Resolution, Sequence[FittedPipeline]]:
    """Resolve a study on its own sensor, or on the nearest that shows what it is run for."""
    facts = fitting.facts
    on = (
        own_sensors(study, facts, fitting.plan)
        if fitting.is_own
        else sensors(study, facts, fitting.plan, partial(fitting.count_own_methods, study))
    )
    wanted = purposes(study, facts)
    own = _resolve_all(study, on, fitting, data_sets, wanted)
    shown = all(departure.part != "condition" for departure in own[0].fidelity.departures)
    if not wanted or (own[0].pipelines and shown):
        return own
    elsewhere = (
        _resolve_all(study, (sensor,), fitting, data_sets, wanted)
        for sensor in _elsewhere(study, on, fitting.plan, wanted)
    )
    return min((own, *elsewhere), key=_remoteness)


def _remoteness(one: tuple[Resolution, Sequence[FittedPipeline]]) -> tuple[bool, int]:
    found, _ = one
    return not found.pipelines, len(found.fidelity.departures)


def _elsewhere(
    study: Study, on: Sequence[Sensor], plan: Plan, wanted: Mapping[Purpose, str]
) -> Iterable[Sensor]:
    """Give the simulated sensors that share one part with the study's, or all where it has none.

    Those with its detector come first, for the light falls onto it alike.
    """
    stated = {attribute: study.of(attribute) for attribute in SENSOR}
    why = f"the nearest sensor of a data set {' and '.join(PURPOSES[p] for p in wanted)}"
    places = [pair for pair in plan if pair not in {sensor.architecture for sensor in on}]

    def shared(pair: Architecture) -> list[bool]:
        return [value in stated[a] for a, value in zip(SENSOR, pair, strict=True)]

    for pair in sorted(places, key=lambda pair: ([not s for s in shared(pair)], pair)):
        if any(shared(pair)) or not any(stated.values()):
            yield Sensor(
                *(
                    cell(study, attribute, value)
                    if value in stated[attribute]
                    else Part(value, "defaulted", why)
                    for attribute, value in zip(SENSOR, pair, strict=True)
                )
            )


def _resolve_all(
    study: Study,
    on: Sequence[Sensor],
    fitting: PipelinesOfStudy,
    data_sets: Mapping[str, DataSet],
    wanted: Mapping[Purpose, str],
) -> tuple[Resolution, Sequence[FittedPipeline]]:
    """Resolve a study on given sensors; return what ran beside it."""
    fitted = fitting.pipelines_by_architecture(study, (sensor.architecture for sensor in on))
    pipelines = tuple(
        _pipeline(
            *(study, sensor, one, fitting.catalogue),
            at=settings(
                *(study, wanted, one.datasets, data_sets),
                lambda at: evidence.distance(study, fitting.facts, at),
            ),
        )
        for sensor in on
        for one in fitted[sensor.architecture]
    )
    ran = [one for found in fitted.values() for one in found]
    gaps = (
        *empty_cells(study, pipelines),
        *(() if fitting.is_own else architecture_gaps(study, fitting.plan, pipelines)),
        *method_gaps(study, ran, on, fitting),
        *nearest_gaps(study),
    )
    state: State = "none" if not pipelines else "partial" if gaps else "complete"
    grade = fidelity(study, fitting.facts, pipelines, ran, wanted)
    return Resolution(study.key, grade, state, pipelines, gaps), ran


def _pipeline(
    study: Study,
    sensor: Sensor,
    one: FittedPipeline,
    catalogue: Catalogue,
    at: tuple[DatasetCondition, ...],
) -> RunnablePipeline:
    extractor = catalogue.extractors[one.extractor.name]
    parts = {
        "detector": sensor.detector,
        "mask": sensor.mask,
        "extractor": _method(study, "extractor", one.extractor),
        "model": _method(study, "model", one.model),
    }
    return RunnablePipeline(
        *sensor.architecture,
        extractor=one.extractor.name,
        model=one.model.name,
        extractor_taxonomy=extractor.about.taxonomy,
        model_taxonomy=one.stages[-1],
        stages=one.stages,
        datasets=one.datasets,
        settings=at,
        basis=MappingProxyType({a: part.basis for a, part in parts.items()}),
        assumed=MappingProxyType({a: part.rule for a, part in parts.items() if part.rule}),
    )


def _method(study: Study, attribute: str, chosen: ChosenMethod) -> Part:
    """Return what a method rests on: the weakest of its stated values, or a rule."""
    if chosen.replaces:
        return Part(chosen.name, "defaulted", _stand_in(attribute, chosen))
    if chosen.variant:
        said: Basis = "inferred" if chosen.variant.basis == "inferred" else "stated"
        return Part(chosen.name, said, chosen.variant.note if said == "inferred" else "")
    if chosen.other_variant:
        return Part(
            chosen.name, "defaulted", f"not as the study has it: {chosen.other_variant.note}"
        )
    if chosen.unsaid:
        return Part(chosen.name, "defaulted", f"one kind of {chosen.unsaid}, which is not stated")
    parts = [cell(study, attribute, value) for value in chosen.runs]
    weakest = max(parts, key=lambda part: BASES.index(part.basis))
    return Part(chosen.name, weakest.basis, weakest.rule)


def _stand_in(attribute: str, chosen: ChosenMethod) -> str:
    """Say by what rule a method that a study does not state stands in its pipeline."""
    if chosen.runs:
        return f"{', '.join(chosen.runs)} ahead of the simplest model that fits"
    if chosen.replaces == NO_IMPLEMENTATION_STATED:
        return f"the survey states no {attribute}; the simplest that fits the sensor is used"
    return f"used instead of {chosen.replaces}, which is not implemented for this sensor"
