"""Which designs meet the requirements, and on what evidence each requirement was judged."""

from __future__ import annotations

import bisect
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from registry.designs import AdviceFor, DesignTable, Kept, Limits, Place
from registry.mapping.advice import ADVISING, Advice
from registry.measured import Measured, Partly
from registry.requirements import EXCLUDE, Requirements

if TYPE_CHECKING:
    from registry.design_columns import Best
    from registry.judged_columns import Judgements

OF_STUDIES = ("task", "error", "accuracy")
"""What is asked of the studies of an architecture."""

_STATED = {"max_error_deg": "accuracy_deg", "min_fov_deg": "fov_deg"}
"""Limits that a study's own number is judged by, where nothing is measured."""

_MEASURED = (
    *("max_error_deg", "min_fov_deg", "survive", "min_availability", "max_latency_us"),
    "exclude_needs",
)


@dataclass(frozen=True, eq=False)
class KeptPlace:
    """An architecture that meets the requirements, with the design that errs least.

    ``advice`` is what advises it for what is asked: for any task or accuracy if neither is.
    ``studies`` are those of its studies (bits) that have what is asked of studies, ``stated``
    those of them whose stated numbers keep the limits too. ``judged`` says what its designs are
    judged by.
    """

    place: Place
    studies: int
    stated: int
    advice: tuple[Advice, ...]
    advised_tasks: frozenset[str]
    judged: Best
    best_at: int
    error_deg: float

    @cached_property
    def best(self) -> Kept:
        """The design that errs least; its error is ``error_deg``, its position ``best_at``."""
        return self.judged.kept(self.best_at)

    @cached_property
    def words(self) -> str:
        """The architecture in words."""
        return " + ".join(self.place.architecture)

    @cached_property
    def backing(self) -> int:
        """How many of its studies have what is asked of studies."""
        return self.studies.bit_count()

    def taken(self, kept: Kept) -> int:
        """Return the studies (bits) that stand for a calibration and meet the requirements."""
        return kept.design.taken & (self.stated if kept.row is None else self.studies)

    def with_model(self, kept: Kept) -> int:
        """Return the studies (bits) that stand for its stages and meet the requirements."""
        return kept.design.with_model & (self.stated if kept.row is None else self.studies)


class Question:
    """Requirements as they are put to a table of designs."""

    def __init__(self, table: DesignTable, requirements: Requirements) -> None:
        from registry.design_columns import design_columns  # noqa: PLC0415 - NumPy

        self.table = table
        self.columns = design_columns(table)
        self.asked = requirements
        self.studies = self._meeting_studies()
        self._of_studies = not all(
            side.keys().isdisjoint(OF_STUDIES)
            for side in (requirements.include, requirements.exclude)
        )
        self.limits = tuple(n for n in _MEASURED if getattr(requirements, n))
        self.judged_by = self.limits_of(requirements)
        self._stated = {name: self._stated_within(name) for name in self.limits}
        # Where nothing is measured, a study's own numbers have to keep all limits.
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
    def best(self) -> Best:
        """The best pipeline of each design among those that keep the limits."""
        return self.columns.best(self.judged_by)

    @cached_property
    def judgements(self) -> Judgements:
        """What every pipeline is judged by."""
        asked = self.asked
        return self.columns.judgements(asked.survive, asked.half_field_deg, asked.draws)

    @cached_property
    def meeting(self) -> int:
        """The designs (bits) that meet the requirements."""
        columns, largest = self.columns, self.asked.largest_deg
        kept = self.best.keeping
        if largest is not None:
            kept &= columns.bits(self.best.error <= largest)
        kept |= columns.stated(self.all_stated)
        for bits in self.having.values():
            kept &= bits
        return kept & self._of_studies_asked if self._of_studies else kept

    @property
    def _of_studies_asked(self) -> int:
        """The designs (bits) of architectures with what is asked of studies, or advised for it."""
        columns, studies = self.columns, self.studies
        found = 0
        for place, bits in zip(self.table.places, columns.of_place, strict=True):
            if place.studies & studies:
                found |= bits
        included = [name for name in OF_STUDIES if name in self.asked.include]
        if not included:
            return found | columns.without_studies
        advised = columns.every
        for name in included:
            values = self.asked.include[name]
            advised &= columns.advised_for(name, values)
        return found | advised

    @cached_property
    def having(self) -> Mapping[str, int]:
        """The designs (bits) that meet each requirement on detector, mask, extractor and so on."""
        columns, facts = self.columns, self.table.facts
        found: dict[str, int] = {}
        for prefix, side in (("", self.asked.include), (EXCLUDE, self.asked.exclude)):
            for attribute, values in side.items():
                if attribute in OF_STUDIES:
                    continue
                kinds = facts.taxonomy.kinds
                has = columns.having(attribute, (k for v in values for k in kinds(attribute, v)))
                found[prefix + attribute] = columns.every & ~has if prefix else has
        if self.asked.properties:
            marks = [facts.properties[name] for name in self.asked.properties]
            extractors = {design.extractor for design in columns.designs}
            marked = (e for e in extractors if all(of.get(e, 0) for of in marks))
            found["properties"] = columns.having("extractor", marked)
        return found

    def count(self) -> int:
        """Return how many architectures meet the requirements."""
        return sum(1 for bits in self.columns.of_place if bits & self.meeting)

    def kept(self, at: int) -> Kept:
        """Return a design that meets the requirements, with what it is judged by."""
        return self.best.kept(at)

    @cached_property
    def finest(self) -> Mapping[int, int]:
        """What errs least of the pipelines that answer too seldom, by place; both by position.

        They are of the calibrations asked for, whatever is asked of studies and errors.
        """
        allowed = self.columns.every
        for name in ("model", "exclude_model", "extractor", "exclude_extractor", "properties"):
            allowed &= self.having.get(name, allowed)
        return self.best.finest(allowed)

    def partly(self, place: int) -> tuple[Partly[Measured], ...]:
        """Return the finest pipeline that answers too seldom on a place, if there is one."""
        at = self.finest.get(place)
        found = None if at is None else self.judgements.partly_of(at)
        return () if found is None else (found,)

    @cached_property
    def advice(self) -> Sequence[AdviceFor]:
        """Of each place the advice for the tasks and accuracies asked for; for any if none is."""
        return self.table.advice.get(
            self.advising, lambda: [self._advice(place.advice) for place in self.table.places]
        )

    @property
    def advising(self) -> tuple[tuple[str, ...] | None, ...]:
        """What advice depends on: the tasks and accuracies asked for."""
        return tuple(self.asked.include.get(name) for name in ADVISING)

    def _advice(self, advice: Iterable[Advice]) -> AdviceFor:
        include = self.asked.include
        asked = [name for name in ADVISING if name in include]
        found = tuple(
            a
            for a in advice
            if (a.requirement in asked and a.value in include[a.requirement])
            or (not asked and a.requirement != "error")
        )
        return found, frozenset(a.value for a in found if a.requirement == "task")

    def advised(self, place: Place, included: Sequence[str]) -> bool:
        """Say whether the survey advises an architecture for everything included."""
        return all(
            any(a.requirement == name and a.value in self.asked.include[name] for a in place.advice)
            for name in included
        )

    def told_by(self, kept: Kept, place: int) -> Hashable:
        """Return all that the numbers told of a measured calibration depend on, as a key."""
        asked, judged = self.asked, self.judgements
        return (
            *(judged.hazards, judged.half, judged.draws, asked.largest_deg),
            *(kept.row_at, self.finest.get(place)),
        )

    def stated(self, limit: str) -> int:
        """Return the studies (bits) whose stated number keeps a limit that is asked."""
        return self._stated[limit]

    def basis(self, place: Place, *, measured: bool) -> dict[str, str]:
        """Say of each requirement whether it was judged on what is measured, stated, and so on."""
        basis = dict.fromkeys(self.limits, "measured" if measured else "stated")
        for name in OF_STUDIES:
            if name in self.asked.include:
                basis[name] = "studies" if place.studies & self.studies else "advised"
        if self.asked.properties:
            basis["properties"] = "assessed"
        return basis

    def _meeting_studies(self) -> int:
        """Return the studies (bits) with the tasks, errors and accuracies asked for."""
        table = self.table
        kept = everyone = (1 << len(table.facts.keys)) - 1
        for attribute, values in self.asked.include.items():
            if attribute in OF_STUDIES:
                kept &= self._having(attribute, values)
        for attribute, values in self.asked.exclude.items():
            if attribute == "task":
                tasks = {v for a, v in table.having if a == "task"}
                others = tasks - set(values)
                others &= set(self.asked.include.get("task", others))
                kept &= self._having("task", others) | (everyone & ~self._having("task", tasks))
            elif attribute in OF_STUDIES:
                kept &= ~self._having(attribute, values)
        return kept

    def _having(self, attribute: str, values: Iterable[str]) -> int:
        found = 0
        for value in values:
            found |= self.table.having.get((attribute, value), 0)
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
