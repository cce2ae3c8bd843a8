"""Which designs meet the requirements, and on what evidence each requirement is judged."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING

from pydantic_core import to_json

from registry.designs import DesignTable, Limits, Place
from registry.mapping.advice import ADVISING, Advice
from registry.requirements import EXCLUDE, Requirements

if TYPE_CHECKING:
    from registry.design_arrays import BestPipelines
    from registry.pipelines import Flags, PipelineErrors

OF_STUDIES = ("task", "error", "accuracy")
"""What is asked of the studies of an architecture."""

_STATED = {"max_error_deg": "accuracy_deg", "min_fov_deg": "fov_deg"}
"""Limits that a study's own number is judged by, where nothing is measured."""

_MEASURED = (
    *("max_error_deg", "min_fov_deg", "survive", "min_availability", "max_latency_us"),
    "exclude_needs",
)


class Question:
    """Requirements as they are put to a table of designs.

    Attributes
    ----------
    arrays : the table as arrays
    studies : studies (bits) with the tasks, errors and accuracies asked for
    all_stated : those of them whose stated numbers keep all limits, too
    limits : names of the limits asked for
    """

    def __init__(self, table: DesignTable, requirements: Requirements) -> None:
        from registry.design_arrays import design_arrays  # noqa: PLC0415 - NumPy

        self.table = table
        self.arrays = design_arrays(table)
        self.asked = requirements
        self.studies = self._meeting_studies()
        self.limits = tuple(n for n in _MEASURED if getattr(requirements, n))
        self._stated = {name: self._stated_within(name) for name in self.limits}
        self.all_stated = self.studies
        for name in self.limits:
            self.all_stated &= self._stated[name]

    @staticmethod
    def limits_of(requirements: Requirements) -> Limits:
        """Return the limits that decide which pipelines are judged."""
        return Limits(
            requirements.survive,
            requirements.half_field_deg,
            requirements.min_availability,
            requirements.max_latency_us,
            requirements.draws,
            requirements.exclude_needs,
        )

    @cached_property
    def asked_json(self) -> bytes:
        """The requirements as JSON."""
        return to_json(self.asked.to_dict())

    @cached_property
    def best(self) -> BestPipelines:
        """The best pipeline of each design among those that keep the limits."""
        asked = self.asked
        # Fields between the same two edges keep the same pipelines.
        half = self.arrays.half_field(asked.half_field_deg)
        return self.arrays.best(
            Limits(
                *(asked.survive, half, asked.min_availability, asked.max_latency_us),
                *(asked.draws, asked.exclude_needs),
            )
        )

    @property
    def errors(self) -> PipelineErrors:
        """The errors that pipelines are judged by."""
        return self.best.errors

    @cached_property
    def matching_designs(self) -> Flags:
        """The designs that meet the requirements."""
        arrays, best, largest = self.arrays, self.best, self.asked.largest_deg
        found: Flags = best.row >= 0
        if largest is not None:
            found &= best.error <= largest
        found |= arrays.stated(self.all_stated)
        for designs in self.designs_with.values():
            found &= designs
        if any(
            name in side for side in (self.asked.include, self.asked.exclude) for name in OF_STUDIES
        ):
            found &= self._places_asked[arrays.place_of]
        return found

    @property
    def _places_asked(self) -> Flags:
        """The architectures that a study with what is asked has, or advice for it means."""
        arrays = self.arrays
        found: Flags = arrays.with_one_of(self.studies)
        included = [name for name in OF_STUDIES if name in self.asked.include]
        if not included:
            found |= arrays.without_studies
            return found
        advised = [arrays.advised_for(name, self.asked.include[name]) for name in included]
        for places in advised[1:]:
            advised[0] &= places
        found |= advised[0]
        return found

    @cached_property
    def designs_with(self) -> Mapping[str, Flags]:
        """The designs that meet each requirement on detector, mask, extractor and so on."""
        arrays, facts = self.arrays, self.table.facts
        kinds = facts.taxonomy.kinds
        found: dict[str, Flags] = {}
        for prefix, side in (("", self.asked.include), (EXCLUDE, self.asked.exclude)):
            for attribute, values in side.items():
                if attribute not in OF_STUDIES:
                    has = arrays.designs_with(
                        attribute, [k for v in values for k in kinds(attribute, v)]
                    )
                    found[prefix + attribute] = ~has if prefix else has
        if self.asked.properties:
            marks = [facts.properties[name] for name in self.asked.properties]
            extractors = {design.extractor for design in arrays.designs}
            marked = [e for e in extractors if all(of.get(e, 0) for of in marks)]
            found["properties"] = arrays.designs_with("extractor", marked)
        return found

    def count(self) -> int:
        """Return how many architectures meet the requirements."""
        return len(set(self.arrays.place_of[self.matching_designs].tolist()))

    @cached_property
    def finer(self) -> Mapping[int, int]:
        """Of each place the finest pipeline that answers too seldom; both by position.

        They are of the calibrations asked for, whatever is asked of studies and errors.
        """
        allowed = self.arrays.numbers >= 0
        for name in ("model", "exclude_model", "extractor", "exclude_extractor", "properties"):
            if name in self.designs_with:
                allowed &= self.designs_with[name]
        return self.errors.finest(self.best.limits, allowed)

    @property
    def advice_key(self) -> tuple[tuple[str, ...] | None, ...]:
        """The tasks and accuracies asked for."""
        return tuple(self.asked.include.get(name) for name in ADVISING)

    def advised(self, place: Place, included: Sequence[str]) -> bool:
        """Say whether the survey advises an architecture for everything included."""
        return all(
            any(a.requirement == name and a.value in self.asked.include[name] for a in place.advice)
            for name in included
        )

    def stated(self, limit: str) -> int:
        """Return the studies (bits) whose stated number keeps a limit that is asked."""
        return self._stated[limit]

    @property
    def judged(self) -> tuple[str, ...]:
        """The requirements that an answer says the basis of: limits, of studies, properties."""
        of_studies = [name for name in OF_STUDIES if name in self.asked.include]
        return (*self.limits, *of_studies, *(["properties"] if self.asked.properties else ()))

    def _meeting_studies(self) -> int:
        """Return the studies (bits) with the tasks, errors and accuracies asked for."""
        table = self.table
        kept = everyone = (1 << len(table.facts.keys)) - 1
        for attribute, values in self.asked.include.items():
            if attribute in OF_STUDIES:
                kept &= self._designs_with(attribute, values)
        for attribute, values in self.asked.exclude.items():
            if attribute == "task":
                tasks = {v for a, v in table.designs_with if a == "task"}
                others = tasks - set(values)
                others &= set(self.asked.include.get("task", others))
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

    def _stated_within(self, limit: str) -> int:
        if limit not in _STATED:
            return 0
        bound = self.asked.limit(limit)
        assert bound is not None  # noqa: S101 - only limits asked for are looked at
        numbers, up_to = self.table.ascending[_STATED[limit]]
        if limit == "min_fov_deg":
            return up_to[-1] & ~up_to[bisect.bisect_left(numbers, bound)]
        return up_to[bisect.bisect_right(numbers, bound)]


def advice_for(
    place: Place, advising: tuple[tuple[str, ...] | None, ...]
) -> tuple[tuple[Advice, ...], frozenset[str]]:
    """Return the advice that means an architecture for what is asked, and its tasks.

    Parameters
    ----------
    place
        The architecture.
    advising
        The tasks and accuracies asked for (`Question.advice_key`); for any if neither is.
    """
    include = {n: v for n, v in zip(ADVISING, advising, strict=True) if v is not None}
    found = tuple(
        a
        for a in place.advice
        if a.value in include.get(a.requirement, ()) or (not include and a.requirement != "error")
    )
    return found, frozenset(a.value for a in found if a.requirement == "task")
