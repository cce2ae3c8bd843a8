"""From a study to what is scored of it: its pipelines, and a reason for everything that is not.

What can be scored is the plan's to say (`registry.taxonomy`): a pipeline is announced only where it
has a cell. What is decided here, because the mapping does not say it:

- The mapping gives a study's values, not which belong together; every combination of them that
  is planned is a pipeline. A value that fits nowhere is a gap, a combination that does not is not.
- The sensor is the study's own; an empty cell is filled by a rule (`registry.sensors`).
- Methods are the study's own with its compensations as stages, or the nearest (`registry.fitting`).
- Every value of a pipeline has a basis. What is not stated is ``assumed``, with the rule that put
  it there: its score is not the study's own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

from registry import catalogue as implementations
from registry import studies as registered
from registry.catalogue import Catalogue
from registry.fitting import Chosen, Fitted, Fitting, stages
from registry.sensors import BASES, SENSOR, Basis, Part, Sensor, cell, sensors
from registry.studies import METHODS, Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Plan

State = Literal["complete", "partial", "none"]

ESSENTIAL = (*SENSOR, "extractor", "model")


@dataclass(frozen=True)
class RunnablePipeline:
    """An extractor and a model, by name, on a sensor of the study, with what each rests on.

    ``stages`` are the model's by their taxonomy values: compensations, and the model itself last.
    ``basis`` says of detector, mask, extractor and model what they rest on, ``assumed`` of those
    that are not stated by what rule they stand there. ``datasets`` are where it is scored.
    """

    detector: str
    mask: str
    extractor: str
    model: str
    extractor_taxonomy: str
    model_taxonomy: str
    stages: tuple[str, ...]
    datasets: tuple[str, ...]
    basis: Mapping[str, Basis] = field(hash=False)
    assumed: Mapping[str, str] = field(hash=False)

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer."""
        return {
            "detector": self.detector,
            "mask": self.mask,
            "extractor": self.extractor,
            "model": self.model,
            "extractor_taxonomy": self.extractor_taxonomy,
            "model_taxonomy": self.model_taxonomy,
            "stages": list(self.stages),
            "basis": dict(self.basis),
            "assumed": dict(self.assumed),
            "datasets": list(self.datasets),
        }


@dataclass(frozen=True)
class Gap:
    """Something of a study that does not run as it is, and why.

    ``attribute`` is one of the study's (value "" if its cell is empty), or "architecture" with
    the value "detector + mask".
    """

    attribute: str
    value: str
    reason: str

    def to_dict(self) -> dict[str, str]:
        """As in the HTTP answer."""
        return {"attribute": self.attribute, "value": self.value, "reason": self.reason}


@dataclass(frozen=True)
class Resolution:
    """What is scored of a study.

    ``state`` is complete (every value of its mapping runs), partial (something of it does, or
    what stands nearest to it) or none.
    """

    study: str
    state: State
    pipelines: tuple[RunnablePipeline, ...]
    gaps: tuple[Gap, ...]

    @property
    def best(self) -> RunnablePipeline | None:
        """The pipeline that rests on most: the first of those whose weakest part is strongest."""
        rank = {basis: at for at, basis in enumerate(BASES)}
        return min(
            self.pipelines,
            key=lambda p: sorted((rank[basis] for basis in p.basis.values()), reverse=True),
            default=None,
        )

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer."""
        return {
            "key": self.study,
            "state": self.state,
            "pipelines": [pipeline.to_dict() for pipeline in self.pipelines],
            "gaps": [gap.to_dict() for gap in self.gaps],
        }


def resolve(
    study: Study | str,
    plan: Plan,
    *,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
) -> Resolution:
    """Every pipeline of a study that is planned, and every gap.

    Parameters
    ----------
    study : Study or str
        A study or its key; InvalidValueError for an unknown key.
    plan : Plan
        What can be scored, as `benchmark.plan.combinations.scorable` gives it.
    catalogue, facts : optional
        What is implemented and the studies; ours and the survey's by default.
    """
    known = facts or registered.facts()
    found = known.study(study) if isinstance(study, str) else study
    return _resolve(found, Fitting(plan, catalogue or implementations.catalogue()), known)


def resolve_all(
    plan: Plan,
    *,
    catalogue: Catalogue | None = None,
    facts: Facts | None = None,
) -> dict[str, Resolution]:
    """`resolve` of every study, by key."""
    known = facts or registered.facts()
    fitting = Fitting(plan, catalogue or implementations.catalogue())
    return {key: _resolve(study, fitting, known) for key, study in known.studies.items()}


def _resolve(study: Study, fitting: Fitting, facts: Facts) -> Resolution:
    on = sensors(study, facts, fitting.plan, lambda pair: fitting.own(study, pair))
    fitted = fitting.fitted(study, (sensor.architecture for sensor in on))
    pipelines = tuple(
        _pipeline(study, sensor, one, fitting.catalogue)
        for sensor in on
        for one in fitted[sensor.architecture]
    )
    ran = [one for found in fitted.values() for one in found]
    gaps = (
        *_empty_cells(study, pipelines),
        *_architecture_gaps(study, fitting.plan, pipelines),
        *_method_gaps(study, ran, on, fitting),
        *_nearest_gaps(study),
    )
    state: State = "none" if not pipelines else "partial" if gaps else "complete"
    return Resolution(study.key, state, pipelines, gaps)


def _pipeline(study: Study, sensor: Sensor, one: Fitted, catalogue: Catalogue) -> RunnablePipeline:
    extractor, model = catalogue.extractors[one.extractor.name], catalogue.models[one.model.name]
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
        model_taxonomy=model.about.taxonomy,
        stages=stages(model),
        datasets=one.datasets,
        basis=MappingProxyType({a: part.basis for a, part in parts.items()}),
        assumed=MappingProxyType({a: part.rule for a, part in parts.items() if part.rule}),
    )


def _method(study: Study, attribute: str, chosen: Chosen) -> Part:
    """Return what a method rests on: the weakest of its stated values, or a rule."""
    if chosen.stands_for:
        return Part(chosen.name, "defaulted", _stand_in(attribute, chosen))
    parts = [cell(study, attribute, value) for value in chosen.runs]
    weakest = max(parts, key=lambda part: BASES.index(part.basis))
    return Part(chosen.name, weakest.basis, weakest.rule)


def _stand_in(attribute: str, chosen: Chosen) -> str:
    """Say by what rule a method that a study does not state stands in its pipeline."""
    if chosen.runs:
        return f"{', '.join(chosen.runs)} ahead of the simplest model that fits"
    if chosen.stands_for == NO_IMPLEMENTATION_STATED:
        return f"the survey maps no {attribute}: the simplest that fits"
    return f"in place of {chosen.stands_for}, which does not run here: the nearest that fits"


def _empty_cells(study: Study, pipelines: Sequence[RunnablePipeline]) -> list[Gap]:
    """Return a gap for each essential attribute without a value, with what fills it."""
    gaps = []
    for attribute in ESSENTIAL:
        if study.of(attribute):
            continue
        rules = dict.fromkeys(p.assumed[attribute] for p in pipelines if attribute in p.assumed)
        filled = f"; filled: {' and '.join(rules)}" if rules else ""
        gaps.append(Gap(attribute, "", f"the mapping states no value{filled}"))
    return gaps


def _architecture_gaps(
    study: Study, plan: Plan, pipelines: Sequence[RunnablePipeline]
) -> list[Gap]:
    """Return a gap for every detector and mask that no pipeline shows, with the reason."""
    gaps = [
        Gap("architecture", f"{detector} + {mask}", "no data set simulates this architecture")
        for detector, mask in study.architectures
        if (detector, mask) not in plan
        and not all(
            any(getattr(p, attribute) == value for p in pipelines)
            for attribute, value in zip(SENSOR, (detector, mask), strict=True)
        )
    ]
    for attribute, at in zip(SENSOR, (0, 1), strict=True):
        for value in study.of(attribute):
            simulated = [pair for pair in study.architectures if pair[at] == value and pair in plan]
            if simulated and not any(getattr(p, attribute) == value for p in pipelines):
                where = _join(" + ".join(pair) for pair in simulated)
                reason = f"none of the study's methods fits a data set of {where}"
                gaps.append(Gap(attribute, value, reason))
    return gaps


def _method_gaps(
    study: Study, ran: Sequence[Fitted], on: Sequence[Sensor], fitting: Fitting
) -> list[Gap]:
    """Return a gap for every extractor and model that no pipeline runs as it is stated."""
    where = _join(dict.fromkeys(" + ".join(sensor.architecture) for sensor in on))
    gaps = []
    for attribute in METHODS:
        run = {value for one in ran for value in getattr(one, attribute).runs}
        for value in study.of(attribute):
            if value in run or (value == NO_IMPLEMENTATION_STATED and ran):
                continue
            reason = _why_not(attribute, value, where, fitting)
            instead = dict.fromkeys(
                getattr(one, attribute).name
                for one in ran
                if getattr(one, attribute).stands_for == value
            )
            if instead:
                reason += f"; {_join(instead)} in its place"
            gaps.append(Gap(attribute, value, reason))
    return gaps


def _nearest_gaps(study: Study) -> list[Gap]:
    """Return a gap for every value that is only the nearest to what the study has."""
    return [
        Gap(attribute, value, f"the study has {name.name}, to which this is the nearest known here")
        for (attribute, value), name in study.names.items()
        if name.nearest
    ]


def _why_not(attribute: str, value: str, where: str, fitting: Fitting) -> str:
    """Say why nothing runs a value: nothing implements it, or it fits no data set."""
    known = fitting.catalogue
    kinds = fitting.kinds(attribute, value)
    if value == NO_IMPLEMENTATION_STATED:
        return f"no simple {attribute} fits the study's other methods"
    asked: list[set[str]] = []
    if attribute == "extractor":
        extractors = [cls for kind in kinds for cls in known.extractors_for(kind)]
        reads = {str(cls.about.observation) for cls in extractors}
    else:
        models = [m for m in known.models.values() if set(stages(m)) & set(kinds)]
        reads = {str(kind) for m in models for kind in m.about.accepts}
        asked = [{*m.about.needs, *m.about.context} for m in models]
    if not reads:
        listed = value if kinds == (value,) else f"any of {', '.join(kinds)}"
        return f"no {attribute} implements {listed}"
    if not where:
        return "no data set simulates an architecture of the study"
    needs = sorted(set.intersection(*asked)) if asked else []
    return (
        f"reads {_join(sorted(reads))}{' and needs ' * bool(needs)}{', '.join(needs)}; "
        f"no data set of {where} offers that to it with the study's other methods"
    )


def _join(words: Iterable[str]) -> str:
    return " or ".join(words)
