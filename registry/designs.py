"""Every design there is evidence of: an architecture with a calibration, its studies, its scores.

An architecture is a detector behind a mask. A calibration on it is an extractor and the stages
that follow, compensations and the model last, as values of the taxonomy: implementations of the
same values are one design, scored as often as there are of them and of data sets.

Built once from the facts and what was measured. Study sets are integers, one bit a study.
"""

from __future__ import annotations

import itertools
import math
import weakref
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

from registry.mapping.advice import Advice
from registry.measured_pipelines import MeasuredPipeline, Measurements, PipelineJudgement
from registry.studies import Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Architecture, Taxonomy

COMPENSATIONS = "Physics-Informed"
"""The category of models that compensate: beside them a study may state no other."""

Stages = tuple[str, ...]
Made = TypeVar("Made")

NOTHING = PipelineJudgement(math.inf, "", None)
"""Judgement of a design without a measured pipeline."""


@dataclass(frozen=True, eq=False)
class Design:
    """A calibration on an architecture.

    ``with_model`` is the bit set of the studies that use its compensations and model on the
    architecture, ``users`` of those that use its extractor, too.
    """

    architecture: Architecture
    extractor: str
    stages: Stages
    with_model: int
    users: int
    rows: tuple[MeasuredPipeline, ...]
    advice: tuple[Advice, ...]

    @cached_property
    def is_advised(self) -> bool:
        """Whether the survey advises it by name."""
        return bool(self.advice)

    @property
    def model(self) -> str:
        """The model: the last stage, after the compensations."""
        return self.stages[-1]

    @cached_property
    def is_specified(self) -> bool:
        """Whether extractor and stages are all known: a study may state none."""
        return NO_IMPLEMENTATION_STATED not in (self.extractor, *self.stages)


@dataclass(frozen=True, eq=False)
class Candidate:
    """A design and its best measured pipeline; without one the error is infinite."""

    design: Design
    row: MeasuredPipeline | None
    judgement: PipelineJudgement

    @property
    def error_deg(self) -> float:
        """The error it is judged by; infinite where there is none."""
        return self.judgement.error_deg


@dataclass(frozen=True)
class Limits:
    """Limits that decide which of a design's pipelines is judged, and how."""

    hazards: tuple[str, ...] = ()
    half_field_deg: float | None = None
    min_availability: float | None = None
    max_latency_us: float | None = None
    draws: tuple[float | None, float] | None = None
    exclude_needs: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Place:
    """An architecture: its studies (bits), its designs, and the advice that means it."""

    architecture: Architecture
    studies: int
    designs: tuple[Design, ...]
    advice: tuple[Advice, ...]
    tasks: Mapping[str, int]  # task -> studies with it, as bits


class DesignTable:
    """Places with their designs, in the order of the taxonomy.

    Parameters
    ----------
    facts : Facts
    measurements : Measurements
    """

    def __init__(self, facts: Facts, measurements: Measurements) -> None:
        self.facts = facts
        self._made: dict[object, Any] = {}
        self.designs_with = _designs_with(facts)
        self.stated_numbers = {
            attribute: tuple(
                (at, number)
                for at, study in enumerate(facts.studies.values())
                if (number := _stated_number(study, attribute)) is not None
            )
            for attribute in ("accuracy_deg", "fov_deg")
        }
        # Numbers in ascending order, and the studies (bits) of the first 0, 1, 2 ... of them.
        self.ascending = {
            attribute: (
                tuple(sorted(number for _, number in pairs)),
                tuple(
                    itertools.accumulate(
                        (1 << at for at, _ in sorted(pairs, key=lambda pair: pair[1])), initial=0
                    )
                ),
            )
            for attribute, pairs in self.stated_numbers.items()
        }
        order = {
            attribute: {v: i for i, v in enumerate(facts.taxonomy.values(attribute))}
            for attribute in ("detector", "mask", "extractor", "model")
        }
        studies: dict[Architecture, dict[int, Study]] = {}
        for at, study in enumerate(facts.studies.values()):
            for architecture in study.architectures:
                studies.setdefault(architecture, {})[at] = study
        architectures = sorted(
            {*studies, *measurements.by_architecture},
            key=lambda pair: (order["detector"][pair[0]], order["mask"][pair[1]]),
        )
        self.places = tuple(
            self._place(
                architecture,
                studies.get(architecture, {}),
                measurements.by_architecture.get(architecture, ()),
                order,
            )
            for architecture in architectures
        )

    def made(self, kind: Callable[[DesignTable], Made]) -> Made:
        """Return what something makes of the table, made at the first call."""
        found: Made | None = self._made.get(kind)
        if found is None:
            found = self._made[kind] = kind(self)
        return found

    def _place(
        self,
        architecture: Architecture,
        studies: Mapping[int, Study],
        rows: Iterable[MeasuredPipeline],
        order: Mapping[str, Mapping[str, int]],
    ) -> Place:
        taxonomy = self.facts.taxonomy
        advice = tuple(a for a in self.facts.advice if a.means(architecture))
        measured: dict[tuple[str, Stages], list[MeasuredPipeline]] = {}
        for row in rows:
            measured.setdefault((row.extractor_taxonomy, row.stages), []).append(row)
        uses = [_StudyMethods(at, study, taxonomy) for at, study in studies.items()]
        found = {key: _sets(uses, *key) for key in measured}
        stated = (
            (use, *pair) for use in uses for pair in itertools.product(use.extractors, use.models)
        )
        for use, extractor, model in stated:
            if not any(
                found[key][1] >> use.at & 1
                and key[0] == extractor
                and _within(taxonomy, model, key[1])
                for key in measured
            ):
                found[extractor, (model,)] = _sets(uses, extractor, (model,))
        designs = [
            Design(
                architecture,
                extractor,
                stages,
                *found[extractor, stages],
                tuple(measured.get((extractor, stages), ())),
                tuple(a for a in advice if a.names(*_name_of(taxonomy, extractor, stages))),
            )
            for extractor, stages in sorted(
                found,
                key=lambda key: (order["extractor"][key[0]], [order["model"][s] for s in key[1]]),
            )
        ]
        everyone = sum(1 << at for at in studies)
        return Place(
            architecture,
            everyone,
            tuple(designs),
            advice,
            {
                task: both
                for task in taxonomy.values("task")
                if (both := everyone & self.designs_with.get(("task", task), 0))
            },
        )


@dataclass
class _StudyMethods:
    """Methods of a study, with the parents of each."""

    at: int
    study: Study
    taxonomy: Taxonomy
    extractors: tuple[str, ...] = field(init=False)
    models: tuple[str, ...] = field(init=False)
    kinds: frozenset[str] = field(init=False)
    only_compensates: bool = field(init=False)  # compensations, and no model behind them

    def __post_init__(self) -> None:
        self.extractors = self.study.has_value("extractor")
        self.models = self.study.has_value("model")
        kinds = (self.taxonomy.kinds("model", model) for model in self.models)
        self.kinds = frozenset(itertools.chain.from_iterable(kinds))
        self.only_compensates = all(
            self.taxonomy.category("model", model) == COMPENSATIONS for model in self.models
        )

    def uses(self, stages: Stages) -> bool:
        """Return whether the study uses all stages; any model counts if it states none."""
        *compensations, model = stages
        if not all(stage in self.kinds for stage in compensations):
            return False
        return model in self.kinds or bool(compensations and self.only_compensates)


def _sets(uses: Iterable[_StudyMethods], extractor: str, stages: Stages) -> tuple[int, int]:
    """Return bit sets of the studies that use the stages, and of those with the extractor, too."""
    with_model = taken = 0
    for use in uses:
        if use.uses(stages):
            with_model |= 1 << use.at
            taken |= (extractor in use.extractors) << use.at
    return with_model, taken


def _within(taxonomy: Taxonomy, model: str, stages: Stages) -> bool:
    return not set(taxonomy.kinds("model", model)).isdisjoint(stages)


def _name_of(
    taxonomy: Taxonomy, extractor: str, stages: Stages
) -> tuple[tuple[str, str], frozenset[str]]:
    """Return what advice may call an extractor, and the categories of its stages."""
    return (
        (extractor, taxonomy.category("extractor", extractor)),
        frozenset(taxonomy.category("model", stage) for stage in stages),
    )


def _stated_number(study: Study, attribute: str) -> float | None:
    """Return a number that a study states as a limit is judged by it: an accuracy as an RMS."""
    if attribute != "accuracy_deg":
        return study.number(attribute)
    found = study.report("accuracy")
    return None if found is None else found.rms_deg


def _designs_with(facts: Facts) -> dict[tuple[str, str], int]:
    """Return the studies (bits) that have each value of what is asked of studies alone."""
    designs_with: dict[tuple[str, str], int] = {}
    for at, study in enumerate(facts.studies.values()):
        for attribute in ("task", "error", "accuracy"):
            for value in study.of(attribute):
                designs_with[attribute, value] = designs_with.get((attribute, value), 0) | 1 << at
    return designs_with


_TABLES: weakref.WeakKeyDictionary[Facts, weakref.WeakKeyDictionary[Measurements, DesignTable]] = (
    weakref.WeakKeyDictionary()
)


def design_table(facts: Facts, measurements: Measurements) -> DesignTable:
    """Return the designs of these facts and measurements, gathered at the first call."""
    tables = _TABLES.setdefault(facts, weakref.WeakKeyDictionary())
    table = tables.get(measurements)
    if table is None:
        table = tables[measurements] = DesignTable(facts, measurements)
    return table
