"""How near what runs of a study is to the study: faithful, assumed, close or a stand-in, by rules.

A study's run has parts: title, sensor, condition, extractors, models, compensations, calibration
and score. A part departs from the study where it *differs*, or where what it would have to be
compared with is *unknown*. It differs where

- a stated sensor is missing, or the run stands on another one;
- none of its settings shows what the study is run for (`registry.fidelity.purposes`);
- an extractor, a model or a compensation that it states runs in none of its pipelines;
- the taxonomy has only the nearest value to its method (`Study.names`);
- only another variant of a method runs than the study's (`method_variants.csv`);
- facts of sensor, calibration or accuracy contradict it (`registry.fidelity.evidence`).

It is unknown where the sensor is recalled, chosen by a rule or a relative's; where the study states
no extractor or model, or not which kind of compensation, or not what stands behind it, and what
stands there was chosen here; and where such facts are missing.

What is inferred with a reason, or implied by the survey's definition of a method that the study
uses, does not depart. Nothing that departs is *faithful*, unknown parts alone *assumed*, one that
differs *close*, more a *stand-in*.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from registry.fidelity.particulars import DIMENSIONS, Purpose
from registry.fidelity.purposes import PURPOSES
from registry.fidelity.runnable import Departure, Part, RunnablePipeline, strongest
from registry.fitting import COMPENSATIONS, FITTED, ChosenMethod, FittedPipeline
from registry.sensors import BASES, SENSOR
from registry.studies import METHODS, Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED
from survey_data.editions import SURVEY
from survey_data.json_data import JsonData

Grade = Literal["faithful", "assumed", "close", "stand-in", "none"]

GRADES: Mapping[Grade, str] = {
    "faithful": "sensor, condition, methods, calibration and score are the study's own",
    "assumed": "nothing known differs, and facts that it takes to judge are unknown",
    "close": "one part differs from the study",
    "stand-in": "more than one part differs from the study",
    "none": "nothing of it runs",
}
"""How near a run is to its study, nearest first, in words."""

TALLIED: Mapping[Grade, str] = {
    "faithful": "faithful",
    "assumed": "assumed",
    "close": "close",
    "stand-in": "stand-in",
    "none": "cannot run",
}
"""What a count of a grade is followed by."""


@dataclass(frozen=True)
class Fidelity(JsonData):
    """The grade of a study's run, in words and by its departures."""

    grade: Grade
    sentence: str
    departures: tuple[Departure, ...] = ()
    purposes: Mapping[Purpose, str] = field(default_factory=dict, hash=False)


def tally(grades: Iterable[Grade]) -> dict[Grade, int]:
    """Count grades, the nearest first."""
    found = list(grades)
    return {grade: found.count(grade) for grade in GRADES}


def tally_text(grades: Iterable[Grade]) -> str:
    """Say how many there are of each grade: `9 faithful, 80 assumed, ...`."""
    return ", ".join(f"{n} {TALLIED[grade]}" for grade, n in tally(grades).items())


def fidelity(
    study: Study,
    facts: Facts,
    pipelines: Sequence[RunnablePipeline],
    ran: Sequence[FittedPipeline],
    wanted: Mapping[Purpose, str],
) -> Fidelity:
    """Grade what runs of a study.

    `pipelines` have the basis of each part and the settings; `ran` are the same as they were
    fitted, with the stated values that each method runs; `wanted` is what the study is run for,
    with the rule that says so.
    """
    if not pipelines:
        return Fidelity("none", _NOTHING, purposes=wanted)
    departures = (
        *_sensor(study, pipelines),
        *_condition(pipelines, wanted),
        *_methods(study, facts, ran),
    )
    leading = strongest(pipelines)
    return graded(study, facts, departures, wanted, pipelines=pipelines, leading=leading, ran=ran)


def graded(
    study: Study,
    facts: Facts,
    departures: Sequence[Departure],
    wanted: Mapping[Purpose, str],
    *,
    pipelines: Sequence[RunnablePipeline],
    leading: Sequence[RunnablePipeline],
    ran: Sequence[FittedPipeline],
) -> Fidelity:
    """Return the grade that all departures make, and the sentence that says them.

    The study is judged by the `leading` pipelines; the rest as of `fidelity`.
    """
    differ = sum(not one.unknown for one in departures)
    grade: Grade = "close" if differ == 1 else "stand-in"
    if not differ:
        grade = "assumed" if departures else "faithful"
    running = {v for one in ran for a in METHODS for v in getattr(one, a).runs}
    more = len(pipelines) - 1
    said = _sentence(study, facts, (leading[0], more), departures, running)
    return Fidelity(grade, said, tuple(departures), wanted)


#: What runs a projection whose constants are fitted.
PROJECTIONS = frozenset(form for forms in FITTED.values() for form in forms)
_NOTHING = "Nothing of it runs: no data set simulates a sensor that its methods fit."


def _sensor(study: Study, pipelines: Sequence[RunnablePipeline]) -> list[Departure]:
    def weakest(pipeline: RunnablePipeline) -> int:
        return max(BASES.index(pipeline.basis[attribute]) for attribute in SENSOR)

    best = min(pipelines, key=weakest)
    weak = [a for a in SENSOR if BASES.index(best.basis[a]) >= BASES.index("recalled")]
    if weak:
        basis = max((best.basis[a] for a in weak), key=BASES.index)
        said = "recalled" if basis == "recalled" else "assumed"
        what = " and ".join(f"{a} ({getattr(best, a)})" for a in weak)
        reasons = "; ".join(dict.fromkeys(best.assumed[a] for a in weak))
        return [
            Departure(
                "sensor",
                f"{best.detector} + {best.mask}",
                f"its {what} {'are' if len(weak) > 1 else 'is'} {said} ({reasons})",
                f"the study's own statement of its {' and '.join(weak)}"
                + (f", and a data set of {_sensor_of(study)}" if _move(study, best) else ""),
                not _move(study, best)
                and not any(study.has_nearest(a, getattr(best, a)) for a in weak),
            )
        ]
    return [
        Departure(
            "sensor",
            cell.value,
            f"its sensor with {attribute} {cell.value} does not run",
            f"a data set of that sensor that its methods fit, or its methods on {cell.value}",
        )
        for attribute in SENSOR
        for cell in study.values.get(attribute, ())
        if cell.basis not in ("inferred", "recalled")
        and all(getattr(pipeline, attribute) != cell.value for pipeline in pipelines)
    ]


def _move(study: Study, pipeline: RunnablePipeline) -> bool:
    """Say whether a pipeline stands on another sensor than one that the study has."""
    return bool(study.architectures) and (
        (pipeline.detector, pipeline.mask) not in study.architectures
    )


def _sensor_of(study: Study) -> str:
    return " or ".join(f"{detector} + {mask}" for detector, mask in study.architectures)


def _condition(
    pipelines: Sequence[RunnablePipeline], wanted: Mapping[Purpose, str]
) -> list[Departure]:
    shown = {p for one in pipelines for setting in one.settings for p in setting.purposes}
    where = " or ".join(dict.fromkeys(f"{one.detector} + {one.mask}" for one in pipelines))
    return [
        Departure(
            "condition",
            purpose,
            f"it is not shown {PURPOSES[purpose]}, for no data set of {where} has that",
            f"a data set of {where} {PURPOSES[purpose]}",
        )
        for purpose in wanted
        if purpose not in shown
    ]


def _methods(study: Study, facts: Facts, ran: Sequence[FittedPipeline]) -> list[Departure]:
    found: list[Departure] = []
    for attribute in METHODS:
        chosen = [getattr(one, attribute) for one in ran]
        for value in study.of(attribute) or (NO_IMPLEMENTATION_STATED,):
            if value == NO_IMPLEMENTATION_STATED:
                found += _not_stated(study, attribute, chosen)
            elif study.has_nearest(attribute, value):
                name = study.names[attribute, value].name
                found.append(_nearest_departure(attribute, value, name, chosen))
            else:
                found += _stated_departures(facts, attribute, value, chosen)
    bare = [d for d in found if d.value == _BEHIND]
    return [d for d in found if d.value != _BEHIND] + bare[:1]


#: Value of the departure of a model behind compensations, of which a study has one.
_BEHIND = "behind its compensation"


def _not_stated(
    study: Study, attribute: str, chosen: Sequence[ChosenMethod]
) -> Iterable[Departure]:
    """Give the departure of a method that is not mapped for a study."""
    if not all(one.runs and not one.replaces for one in chosen):
        who = "the survey" if study.edition == SURVEY else "its row"
        text = f"{who} states no {attribute}, so {_names(chosen)} is chosen"
        part: Part = "extractor" if attribute == "extractor" else "model"
        yield Departure(part, "None", text, f"the {attribute} that the study uses, if any", True)


def _nearest_departure(
    attribute: str, value: str, name: str, chosen: Sequence[ChosenMethod]
) -> Departure:
    """Return the departure of a method that the taxonomy has only the nearest value for."""
    running = _names([one for one in chosen if value in one.runs])
    text = f"{name} is not implemented" + (f"; {running} is used instead" if running else "")
    part: Part = "extractor" if attribute == "extractor" else "model"
    return Departure(part, value, text, f"an implementation of {name}")


def _stated_departures(
    facts: Facts, attribute: str, value: str, chosen: Sequence[ChosenMethod]
) -> Iterable[Departure]:
    """Give the departure of a method that a study states."""
    name = _small(facts.taxonomy.name(attribute, value))
    compensates = facts.taxonomy.category(attribute, value) == COMPENSATIONS
    part: Part = "compensation" if compensates else "model"
    if attribute == "extractor":
        part = "extractor"
    running = [one for one in chosen if value in one.runs]
    variants = [one.other_variant for one in running if one.other_variant]
    missed = [variant for variant in variants if variant.model == value]
    if not running:
        instead = _names([one for one in chosen if one.replaces == value])
        text = f"its {name} is not implemented"
        text += f"; {instead} is used instead" if instead else ""
        settled = f"an implementation of {value} for this sensor"
        yield Departure(part, value, text, settled)
    elif len(missed) == len(running):
        text = f"its {name} runs as another variant ({missed[0].note})"
        yield Departure(part, value, text, f"an implementation of {value} as the study has it")
    elif all(one.unsaid == value for one in running):
        text = f"the kind of its {name} is chosen, {_names(running)}"
        yield Departure(part, value, text, f"what the study says of its {value}", True)
    elif compensates and all(one.replaces for one in running):
        text = f"the model behind its {name} is assumed: {_names(running)}"
        settled = "the model that the study combines with this compensation"
        yield Departure("model", _BEHIND, text, settled, True)


def _names(chosen: Sequence[ChosenMethod]) -> str:
    return " or ".join(dict.fromkeys(one.name for one in chosen))


def _sentence(
    study: Study,
    facts: Facts,
    shown: tuple[RunnablePipeline, int],
    departures: Sequence[Departure],
    running: Collection[str],
) -> str:
    """Say what runs where beside how many more, and what is missing or chosen.

    Dimensions that are unknown stand in a sentence of their own.
    """
    best, more = shown
    stated = [
        _small(facts.taxonomy.name(attribute, value))
        for attribute in METHODS
        for value in study.of(attribute)
        if value in running and not study.has_nearest(attribute, value)
    ]
    at = best.settings[0]
    lead = f"Implemented as {best.extractor} + {best.model} on {at.dataset} ({at.condition})"
    if more:
        lead += f" and {more} more pipeline{'s' * (more > 1)}"
    if stated:
        lead += f": {_list_items(stated)}"
    if best.model.split(" + ")[-1] in PROJECTIONS and best.model_taxonomy == "SPM":
        lead += " (projection, constants fitted)"
    if departures:
        clauses = [one.text for one in departures if one.value != DIMENSIONS]
        alone = [_dimensions_sentence(one) for one in departures if one.value == DIMENSIONS]
        return " ".join((f"{'; '.join((lead, *clauses))}.", *alone))
    inferred = [a for a in SENSOR if best.basis[a] in ("inferred", "implied")]
    verb = "are" if len(inferred) > 1 else "is"
    return lead + (f"; its {_list_items(inferred)} {verb} inferred." if inferred else ".")


def _dimensions_sentence(departure: Departure) -> str:
    """Say that dimensions of the sensor are unknown, with their count, as a sentence."""
    return f"{departure.text}; its data set assumes them."


def _small(name: str) -> str:
    """Return a name as it stands within a sentence, its kind in brackets."""
    what, _, kind = name.removesuffix(" (kind not stated)").partition(": ")
    first, _, rest = what.partition(" ")
    small = f"{first if first.isupper() else first.lower()} {rest}".strip()
    return f"{small} ({kind})" if kind else small


def _list_items(words: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(words[:-1]), words[-1])))
