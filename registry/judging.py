"""Select the designs that meet requirements, and the evidence that decides each requirement."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property, reduce
from operator import and_
from typing import TYPE_CHECKING

from pydantic_core import to_json

from registry.designs import DesignTable, Limits, Place
from registry.mapping.advice import ADVISING, Advice
from registry.requirements import EXCLUDE, Requirements

if TYPE_CHECKING:
    from registry.design_arrays import BestPipelines
    from registry.pipelines import Flags, PipelineErrors

OF_STUDIES = ("task", "error", "accuracy")
"""Requirements on the studies of an architecture, not on a design."""

_STATED = {"max_error_deg": "accuracy_deg", "min_fov_deg": "fov_deg"}
"""Limits that a study's stated number is compared with, where nothing is measured."""

_MEASURED = (
    *("max_error_deg", "min_fov_deg", "survive", "min_availability", "max_latency_us"),
    "exclude_needs",
)


class Question:
    """Requirements applied to a table of designs.

    Attributes
    ----------
    arrays : the table as arrays
    studies : bit set of the studies with the required tasks, errors and accuracies
    studies_within_limits : bit set of those whose stated numbers are within all limits, too
    limits : names of the required limits
    """

    def __init__(self, table: DesignTable, requirements: Requirements) -> None:
        from registry.design_arrays import design_arrays  # noqa: PLC0415 - NumPy

        self.table = table
        self.arrays = design_arrays(table)
        self.requirements = requirements
        self.studies = self._find_studies()
        self.limits = tuple(n for n in _MEASURED if getattr(requirements, n))
        self._studies_within = {name: self._find_studies_within(name) for name in self.limits}
        self.studies_within_limits = self.studies
        for name in self.limits:
            self.studies_within_limits &= self._studies_within[name]

    @property
    def stated_of_unmeasured(self) -> int:
        """Studies within all limits that use an unmeasured design, or its compensations and model.

        Stated numbers decide on unmeasured designs alone, so no other study has to be known. Many
        questions have the same set (bits), and share what is kept by it.
        """
        return self.studies_within_limits & self.arrays.studies_of_unmeasured

    @staticmethod
    def limits_of(requirements: Requirements) -> Limits:
        """Return the limits by which measured pipelines are selected and judged."""
        return Limits(
            requirements.survive,
            requirements.half_field_deg,
            requirements.min_availability,
            requirements.max_latency_us,
            requirements.draws,
            requirements.exclude_needs,
        )

    @cached_property
    def requirements_json(self) -> bytes:
        """The requirements as JSON."""
        return to_json(self.requirements.to_dict())

    @cached_property
    def best_pipelines(self) -> BestPipelines:
        """The most accurate pipeline within the limits, of each design."""
        asked = self.requirements
        # Fields between the same two edges select the same pipelines.
        half = self.arrays.half_field(asked.half_field_deg)
        return self.arrays.best_pipelines(
            Limits(
                *(asked.survive, half, asked.min_availability, asked.max_latency_us),
                *(asked.draws, asked.exclude_needs),
            )
        )

    @property
    def errors(self) -> PipelineErrors:
        """Errors of all pipelines under the required hazards, field and confidence."""
        return self.best_pipelines.errors

    @cached_property
    def matching_designs(self) -> Flags:
        """Mask over designs: true for those that meet all requirements."""
        arrays, best, largest = self.arrays, self.best_pipelines, self.requirements.largest_deg
        found: Flags = best.row >= 0
        if largest is not None:
            found &= best.error <= largest
        found |= arrays.unmeasured_designs_of(self.stated_of_unmeasured)
        for designs in self.designs_with.values():
            found &= designs
        asked = {*self.requirements.include, *self.requirements.exclude}
        if not asked.isdisjoint(OF_STUDIES):
            found &= self._places_asked.take(arrays.place_of)
        return found

    @property
    def _places_asked(self) -> Flags:
        """Mask over architectures: used by a study that meets the requirements, or advised."""
        arrays = self.arrays
        found: Flags = arrays.with_one_of(self.studies)
        included = [name for name in OF_STUDIES if name in self.requirements.include]
        if not included:
            found |= arrays.without_studies
            return found
        advised = [arrays.advised_for(name, self.requirements.include[name]) for name in included]
        found |= reduce(and_, advised)
        return found

    @cached_property
    def designs_with(self) -> Mapping[str, Flags]:
        """Masks over designs, one for each requirement on a design: true for those that meet it."""
        arrays, facts = self.arrays, self.table.facts
        kinds = facts.taxonomy.kinds
        found: dict[str, Flags] = {}
        for prefix, side in (("", self.requirements.include), (EXCLUDE, self.requirements.exclude)):
            for attribute, values in side.items():
                if attribute not in OF_STUDIES:
                    has = arrays.designs_with(
                        attribute, [k for v in values for k in kinds(attribute, v)]
                    )
                    found[prefix + attribute] = ~has if prefix else has
        if self.requirements.properties:
            marks = [facts.properties[name] for name in self.requirements.properties]
            extractors = {design.extractor for design in arrays.designs}
            marked = [e for e in extractors if all(of.get(e, 0) for of in marks)]
            found["properties"] = arrays.designs_with("extractor", marked)
        return found

    def count(self) -> int:
        """Return how many architectures meet the requirements."""
        return self.arrays.count_places(self.matching_designs)

    @cached_property
    def finest_partial_answers(self) -> Mapping[int, int]:
        """Most accurate pipeline below the availability limit, by architecture (positions).

        Only calibrations that meet the requirements on model, extractor and properties count.
        """
        names = ("model", "exclude_model", "extractor", "exclude_extractor", "properties")
        allowed = [self.designs_with[name] for name in names if name in self.designs_with]
        return self.errors.finest(self.best_pipelines.limits, allowed)

    @property
    def advice_key(self) -> tuple[tuple[str, ...] | None, ...]:
        """The required values of each attribute that the survey gives advice on."""
        return tuple(self.requirements.include.get(name) for name in ADVISING)

    def is_advised(self, place: Place, included: Sequence[str]) -> bool:
        """Return whether the survey advises an architecture for all of some requirements."""
        return all(
            any(
                a.requirement == name and a.value in self.requirements.include[name]
                for a in place.advice
            )
            for name in included
        )

    def studies_within(self, limit: str) -> int:
        """Return the bit set of the studies whose stated number is within a limit."""
        return self._studies_within[limit]

    @property
    def judged_requirements(self) -> tuple[str, ...]:
        """Requirements for which an answer states the evidence."""
        of_studies = [name for name in OF_STUDIES if name in self.requirements.include]
        return (
            *self.limits,
            *of_studies,
            *(["properties"] if self.requirements.properties else ()),
        )

    def _find_studies(self) -> int:
        """Return the bit set of the studies with the required tasks, errors and accuracies."""
        table = self.table
        kept = everyone = (1 << len(table.facts.keys)) - 1
        for attribute, values in self.requirements.include.items():
            if attribute in OF_STUDIES:
                kept &= self._designs_with(attribute, values)
        for attribute, values in self.requirements.exclude.items():
            if attribute == "task":
                tasks = {v for a, v in table.designs_with if a == "task"}
                others = tasks - set(values)
                others &= set(self.requirements.include.get("task", others))
                without = everyone & ~self._designs_with("task", tasks)
                kept &= self._designs_with("task", others) | without
            elif attribute in OF_STUDIES:
                kept &= ~self._designs_with(attribute, values)
        return kept

    def _designs_with(self, attribute: str, values: Iterable[str]) -> int:
        found = 0
        for value in values:
            found |= self.table.designs_with.get((attribute, value), 0)
        return found

    def _find_studies_within(self, limit: str) -> int:
        if limit not in _STATED:
            return 0
        bound = self.requirements.limit(limit)
        assert bound is not None  # noqa: S101 - only limits asked for are looked at
        numbers, up_to = self.table.ascending[_STATED[limit]]
        if limit == "min_fov_deg":
            return up_to[-1] & ~up_to[bisect.bisect_left(numbers, bound)]
        return up_to[bisect.bisect_right(numbers, bound)]


def advice_for(
    place: Place, advising: tuple[tuple[str, ...] | None, ...]
) -> tuple[tuple[Advice, ...], frozenset[str]]:
    """Return the survey's advice for an architecture that fits the requirements, and its tasks.

    Parameters
    ----------
    place
        The architecture.
    advising
        The required values (`Question.advice_key`); all advice fits if there are none.
    """
    include = {n: v for n, v in zip(ADVISING, advising, strict=True) if v is not None}
    found = tuple(
        a
        for a in place.advice
        if a.value in include.get(a.requirement, ()) or (not include and a.requirement != "error")
    )
    return found, frozenset(a.value for a in found if a.requirement == "task")
