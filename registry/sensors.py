"""The sensor of a study: its detector and mask, each with what it rests on.

A cell of the mapping is stated, inferred or recalled. An empty one is filled by the first rule of
the survey's data (`defaults.csv`) whose conditions the study meets; where no rule applies, the
study is set on the architecture of its nearest relatives, and says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

from registry.studies import METHODS, Default, Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Architecture

Basis = Literal["stated", "inferred", "implied", "recalled", "defaulted"]

BASES: tuple[Basis, ...] = ("stated", "inferred", "implied", "recalled", "defaulted")
"""What a value of a pipeline rests on, strongest first: the study's own text, a conclusion from it,
the survey's definition of a method that the study uses, memory, a choice of ours."""

SENSOR = ("detector", "mask")

#: What two studies share where they are relatives.
_ALIKE = (*METHODS, "error")


@dataclass(frozen=True)
class Part:
    """A value, what it rests on, and, where it is not stated, why it stands there."""

    value: str
    basis: Basis
    rule: str = ""


@dataclass(frozen=True)
class Sensor:
    """An architecture that a study is run on."""

    detector: Part
    mask: Part

    @property
    def architecture(self) -> Architecture:
        """Detector and mask."""
        return self.detector.value, self.mask.value


def cell(study: Study, attribute: str, value: str) -> Part:
    """Return a stated value with its basis and, where that is weak, the reason in its note.

    A value that is only the nearest to what the study has is not its own.
    """
    if study.has_nearest(attribute, value):
        name = study.names[attribute, value].name
        return Part(value, "defaulted", f"the nearest in the taxonomy to {name}")
    found = next(c for c in study.values[attribute] if c.value == value)
    if found.basis not in ("inferred", "recalled"):
        return Part(value, "stated")
    basis: Basis = "inferred" if found.basis == "inferred" else "recalled"
    return Part(value, basis, found.note or "the mapping gives no reason")


def sensors(
    study: Study,
    facts: Facts,
    simulated: Iterable[Architecture],
    runs: Callable[[Architecture], int],
) -> tuple[Sensor, ...]:
    """Return what a study is run on: its own architectures, or those that rules give it.

    Architectures that are not `simulated` are left out; `runs` counts the study's own methods that
    run on one.
    """
    known = frozenset(simulated)
    filled = {attribute: _fill(study, attribute, facts.defaults) for attribute in SENSOR}
    if all(filled.values()):
        pairs = study.architectures or tuple(
            (d, m) for d in filled["detector"] for m in filled["mask"]
        )
        return tuple(
            Sensor(filled["detector"][d], filled["mask"][m]) for d, m in pairs if (d, m) in known
        )
    relatives = _relatives(study, facts, known, filled, runs)
    return (relatives,) if relatives else ()


def own_sensors(
    study: Study, facts: Facts, architectures: Iterable[Architecture]
) -> tuple[Sensor, ...]:
    """Return what data sets made after a study alone have, whatever else its mapping infers.

    A value that the mapping does not have is inferred from what is known of the built sensor.
    """

    def part(attribute: str, value: str) -> Part:
        if value in study.of(attribute):
            return cell(study, attribute, value)
        built = facts.run_facts.get(study.key, ())
        ids = [one.note for one in built if (one.fact, one.value) == (attribute, value)]
        if not ids:
            return Part(value, "defaulted", "of the data set made after it")
        mapped = " and ".join(study.of(attribute))
        return Part(value, "inferred", f"built so (hardware {ids[0]}); the mapping has {mapped}")

    return tuple(Sensor(part("detector", d), part("mask", m)) for d, m in architectures)


def _fill(study: Study, attribute: str, defaults: Iterable[Default]) -> dict[str, Part]:
    """Return the values of an attribute: stated, or by the first rule that applies; or none."""
    if study.of(attribute):
        return {value: cell(study, attribute, value) for value in study.of(attribute)}
    for rule in defaults:
        if rule.attribute == attribute and all(v in study.of(a) for a, v in rule.conditions):
            basis: Basis = "implied" if rule.kind == "implied" else "defaulted"
            return {rule.value: Part(rule.value, basis, f"{rule.id}: {rule.rule}")}
    return {}


def _relatives(
    study: Study,
    facts: Facts,
    simulated: frozenset[Architecture],
    filled: dict[str, dict[str, Part]],
    runs: Callable[[Architecture], int],
) -> Sensor | None:
    """Return the architecture of the nearest relatives that runs most of the study's methods.

    Near is who shares the greatest part of models, extractors and errors with it, then who is of
    the nearest year; the first by key of equals.
    """
    ranked = []
    for other in facts.studies.values():
        alike = _share(study, other)
        if other.key == study.key or not alike:
            continue
        years = abs((other.year or 0) - (study.year or 0))
        ranked += [
            ((-runs(pair), -alike, years, other.key), pair)
            for pair in other.architectures
            if pair in simulated
            and all(v in (filled[a] or (v,)) for a, v in zip(SENSOR, pair, strict=True))
        ]
    if not ranked:
        return None
    (_, alike, *_), (detector, mask) = min(ranked)
    near = sorted(rank[3] for rank, pair in ranked if pair == (detector, mask) and rank[1] == alike)
    rule = (
        f"no rule applies: the architecture of its nearest relative{'s' * (len(near) > 1)} "
        f"{', '.join(near)} by methods and errors in common"
    )
    return Sensor(
        *(
            filled[attribute].get(value) or Part(value, "defaulted", rule)
            for attribute, value in (("detector", detector), ("mask", mask))
        )
    )


def _share(study: Study, other: Study) -> float:
    """Return the share of methods and errors that two studies have in common."""
    ours, theirs = _methods_and_errors(study), _methods_and_errors(other)
    return len(ours & theirs) / max(1, len(ours | theirs))


def _methods_and_errors(study: Study) -> set[tuple[str, str]]:
    return {
        (attribute, value)
        for attribute in _ALIKE
        for value in study.of(attribute)
        if value != NO_IMPLEMENTATION_STATED
    }
