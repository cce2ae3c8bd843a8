"""What of a study does not run as it is, and why."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from registry.fidelity.runnable import ESSENTIAL, Gap, RunnablePipeline
from registry.fitting import FittedPipeline, PipelinesOfStudy, stages
from registry.sensors import SENSOR, Sensor
from registry.studies import METHODS, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Plan


def empty_cells(study: Study, pipelines: Sequence[RunnablePipeline]) -> list[Gap]:
    """Return a gap for each essential attribute without a value, with what fills it."""
    gaps = []
    for attribute in ESSENTIAL:
        if study.of(attribute):
            continue
        known = [p.assumed for p in pipelines if attribute in p.assumed]
        rules = dict.fromkeys(rule[attribute] for rule in known)
        filled = f"; filled: {' and '.join(rules)}" if rules else ""
        gaps.append(Gap(attribute, "", f"the mapping states no value{filled}"))
    return gaps


def architecture_gaps(study: Study, plan: Plan, pipelines: Sequence[RunnablePipeline]) -> list[Gap]:
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


def method_gaps(
    study: Study, ran: Sequence[FittedPipeline], on: Sequence[Sensor], fitting: PipelinesOfStudy
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
                if getattr(one, attribute).replaces == value
            )
            if instead:
                reason += f"; {_join(instead)} is used instead"
            gaps.append(Gap(attribute, value, reason))
    return gaps


def nearest_gaps(study: Study) -> list[Gap]:
    """Return a gap for every value that is only the nearest to what the study has."""
    return [
        Gap(attribute, value, f"the study has {name.name}, to which this is the nearest known here")
        for (attribute, value), name in study.names.items()
        if name.is_nearest
    ]


def _why_not(attribute: str, value: str, where: str, fitting: PipelinesOfStudy) -> str:
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
