"""Every design there is evidence of: an architecture with a calibration, its studies, its scores.

An architecture is a detector behind a mask. A calibration on it is an extractor and the stages
that follow, compensations and the model last, as values of the taxonomy: implementations of the
same values are one design, scored as often as there are of them and of data sets.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from registry.fidelity.particulars import Advice
from registry.measured_pipelines import MeasuredPipeline, Measurements
from registry.studies import Facts, Study
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Architecture, Taxonomy
from survey_data.products import Product, products

COMPENSATIONS = "Physics-Informed"
"""The category of models that compensate: beside them a study may state no other."""

Stages = tuple[str, ...]
Order = Mapping[str, Mapping[str, int]]


@dataclass(frozen=True, eq=False)
class Design:
    """A calibration on an architecture.

    ``with_model`` are the studies that use its compensations and model on the architecture,
    ``users`` those that use its extractor, too.
    """

    architecture: Architecture
    extractor: str
    stages: Stages
    with_model: frozenset[str]
    users: frozenset[str]
    rows: tuple[MeasuredPipeline, ...]
    advice: tuple[Advice, ...]

    @property
    def model(self) -> str:
        """The model: the last stage, after the compensations."""
        return self.stages[-1]

    @property
    def is_specified(self) -> bool:
        """Whether extractor and stages are all known: a study may state none."""
        return NO_IMPLEMENTATION_STATED not in (self.extractor, *self.stages)


@dataclass(frozen=True, eq=False)
class Place:
    """An architecture: its studies and built sensors, its designs, and the advice that means it."""

    architecture: Architecture
    studies: Mapping[str, Study]
    products: tuple[Product, ...]
    designs: tuple[Design, ...]
    advice: tuple[Advice, ...]

    @property
    def is_built(self) -> bool:
        """Whether a study or a product realises it."""
        return bool(self.studies or self.products)

    def is_advised_for(self, requirement: str, values: Collection[str]) -> bool:
        """Say whether the survey advises it for one of some values of a requirement."""
        return any(a.requirement == requirement and a.value in values for a in self.advice)


def gather(facts: Facts, measurements: Measurements) -> tuple[Place, ...]:
    """Return what is studied, built or measured, in the order of the taxonomy."""
    order = {
        attribute: {v: i for i, v in enumerate(facts.taxonomy.values(attribute))}
        for attribute in ("detector", "mask", "extractor", "model")
    }
    studies: dict[Architecture, dict[str, Study]] = {}
    for key, study in facts.studies.items():
        for architecture in study.architectures:
            studies.setdefault(architecture, {})[key] = study
    built: dict[Architecture, list[Product]] = {}
    for product in products():
        if product.detector in order["detector"] and product.mask in order["mask"]:
            built.setdefault((product.detector, product.mask), []).append(product)
    measured, on_ground = measurements.by_architecture, measurements.on_ground.by_architecture
    every = sorted(
        {*studies, *built, *measured},
        key=lambda pair: (order["detector"][pair[0]], order["mask"][pair[1]]),
    )
    found = []
    for pair in every:
        there, advice = studies.get(pair, {}), tuple(a for a in facts.advice if a.means(pair))
        rows = measured.get(pair, ()), on_ground.get(pair, ())
        designs = _designs(facts.taxonomy, pair, there, *rows, advice, order)
        found.append(Place(pair, there, tuple(built.get(pair, ())), designs, advice))
    return tuple(found)


def _designs(  # noqa: PLR0917 - what a design is gathered from
    taxonomy: Taxonomy,
    architecture: Architecture,
    studies: Mapping[str, Study],
    rows: Iterable[MeasuredPipeline],
    on_ground: Iterable[MeasuredPipeline],
    advice: Sequence[Advice],
    order: Order,
) -> tuple[Design, ...]:
    measured: dict[tuple[str, Stages], list[MeasuredPipeline]] = {}
    for row in rows:
        measured.setdefault((row.extractor_taxonomy, row.stages), []).append(row)
    methods = [_Methods(study, taxonomy) for study in studies.values()]
    for row in on_ground:
        key = row.extractor_taxonomy, row.stages
        if key not in measured and _users(methods, *key)[1]:
            measured[key] = []
    found = {key: _users(methods, *key) for key in measured}
    for one in methods:
        for extractor, model in itertools.product(one.extractors, one.models):
            kinds = set(taxonomy.kinds("model", model))
            if not any(
                key[0] == extractor and one.key in found[key][1] and not kinds.isdisjoint(key[1])
                for key in measured
            ):
                found[extractor, (model,)] = _users(methods, extractor, (model,))
    return tuple(
        Design(
            architecture,
            extractor,
            stages,
            *found[extractor, stages],
            tuple(measured.get((extractor, stages), ())),
            tuple(a for a in advice if a.names(*_named(taxonomy, extractor, stages))),
        )
        for extractor, stages in sorted(
            found,
            key=lambda key: (order["extractor"][key[0]], [order["model"][s] for s in key[1]]),
        )
    )


class _Methods:
    """Extractors and models that a study stands for, with the kinds of its models."""

    def __init__(self, study: Study, taxonomy: Taxonomy) -> None:
        self.key = study.key
        self.extractors = study.has_value("extractor")
        self.models = study.has_value("model")
        self.kinds = {kind for model in self.models for kind in taxonomy.kinds("model", model)}
        self.only_compensates = all(
            taxonomy.category("model", model) == COMPENSATIONS for model in self.models
        )

    def uses(self, stages: Stages) -> bool:
        """Return whether the study uses all stages; any model counts if it states none."""
        *compensations, model = stages
        if not self.kinds.issuperset(compensations):
            return False
        return model in self.kinds or bool(compensations and self.only_compensates)


def _users(
    methods: Iterable[_Methods], extractor: str, stages: Stages
) -> tuple[frozenset[str], frozenset[str]]:
    """Return the studies that use the stages, and those of them that use the extractor."""
    with_model = [one for one in methods if one.uses(stages)]
    users = frozenset(one.key for one in with_model if extractor in one.extractors)
    return frozenset(one.key for one in with_model), users


def _named(
    taxonomy: Taxonomy, extractor: str, stages: Stages
) -> tuple[tuple[str, str], frozenset[str]]:
    """Return what advice may call an extractor, and the categories of its stages."""
    return (
        (extractor, taxonomy.category("extractor", extractor)),
        frozenset(taxonomy.category("model", stage) for stage in stages),
    )
