"""Which designs meet the requirements, and on what evidence each requirement was judged."""

from __future__ import annotations

import bisect
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from registry.advice import ADVISING, Advice
from registry.designs import NOTHING, Design, DesignTable, Kept, Limits, Place
from registry.measured import Measured, Partly
from registry.requirements import EXCLUDE, Requirements

OF_STUDIES = ("task", "error", "accuracy")
"""What is asked of the studies of an architecture."""

OF_DESIGN = ("extractor", "model")
OF_PLACE = ("detector", "mask")

_STATED = {"max_error_deg": "accuracy_deg", "min_fov_deg": "fov_deg"}
"""Limits that a study's own number is judged by, where nothing is measured."""

_MEASURED = ("max_error_deg", "min_fov_deg", "survive", "min_availability", "max_latency_us")


@dataclass(frozen=True, eq=False)
class KeptPlace:
    """An architecture that meets the requirements, with the designs that do.

    ``advice`` is what advises it for what is asked: for any task or accuracy if neither is.
    ``studies`` are those of its studies (bits) that have what is asked of studies, ``stated``
    those of them whose stated numbers keep the limits too.
    """

    place: Place
    studies: int
    stated: int
    advice: tuple[Advice, ...]
    designs: tuple[Kept, ...]  # measured ones first, the least error first

    @property
    def best(self) -> Kept:
        """The design that errs least."""
        return self.designs[0]

    def taken(self, kept: Kept) -> int:
        """Return the studies (bits) that stand for a calibration and meet the requirements."""
        return kept.design.taken & (self.stated if kept.row is None else self.studies)

    def with_model(self, kept: Kept) -> int:
        """Return the studies (bits) that stand for its stages and meet the requirements."""
        return kept.design.with_model & (self.stated if kept.row is None else self.studies)


class Question:
    """Requirements as they are put to a table of designs."""

    def __init__(self, table: DesignTable, requirements: Requirements) -> None:
        self.table = table
        self.asked = requirements
        self.judged = table.judged(requirements.survive, requirements.half_field_deg)
        self.studies = self._meeting_studies()
        self._sets = {
            prefix + attribute: self._values(attribute, values)
            for prefix, side in (("", requirements.include), (EXCLUDE, requirements.exclude))
            for attribute, values in side.items()
        }
        self._of_design = bool(requirements.properties) or any(
            name.removeprefix(EXCLUDE) in OF_DESIGN for name in self._sets
        )
        self.limits = tuple(n for n in _MEASURED if requirements.asked(n) is not None)
        self._judged_by = Limits(
            requirements.survive,
            requirements.half_field_deg,
            requirements.min_availability,
            requirements.max_latency_us,
        )
        self._stated = {name: self._stated_within(name) for name in self.limits}
        self._all_stated = self.studies
        for name in self.limits:
            self._all_stated &= self._stated[name]

    def places(self) -> list[KeptPlace]:
        """Return the architectures that meet the requirements, in the order of the taxonomy."""
        found = []
        for place, best in zip(self.table.places, self.table.best(self._judged_by), strict=True):
            if self.broken_by_place(place) or self.broken_by_studies(place):
                continue
            kept = self._kept(place, best)
            if kept:
                studies = place.studies & self.studies
                stated = place.studies & self._all_stated
                advice = self.advice(place.advice)
                found.append(KeptPlace(place, studies, stated, advice, kept))
        return found

    def partly(self, place: Place) -> tuple[Partly[Measured], ...]:
        """Return pipelines of what is asked for that answer too seldom, the least error first."""
        parts = self.table.partly(self._judged_by)[place.architecture]
        return tuple(part for design, part in parts if not self.broken_by_design(design))

    def advice(self, advice: Iterable[Advice]) -> tuple[Advice, ...]:
        """Return the advice for the tasks and accuracies asked for; for any if none is."""
        include = self.asked.include
        asked = [name for name in ADVISING if name in include]
        return tuple(
            a
            for a in advice
            if a.requirement in ADVISING
            and (not asked or (a.requirement in asked and a.value in include[a.requirement]))
        )

    def broken_by_place(self, place: Place) -> list[str]:
        """Return the requirements on detector and mask that an architecture breaks."""
        return [
            name
            for name, values in self._sets.items()
            for attribute, value in zip(OF_PLACE, place.architecture, strict=True)
            if name.removeprefix(EXCLUDE) == attribute
            and (value in values) == name.startswith(EXCLUDE)
        ]

    def broken_by_design(self, design: Design) -> list[str]:
        """Return the requirements on extractor, model and properties that a calibration breaks."""
        broken = []
        for name, values in self._sets.items():
            attribute = name.removeprefix(EXCLUDE)
            if attribute in OF_DESIGN:
                has = (design.extractor,) if attribute == "extractor" else design.stages
                if values.isdisjoint(has) != name.startswith(EXCLUDE):
                    broken.append(name)
        marks = self.table.facts.properties
        if not all(marks[name].get(design.extractor, 0) for name in self.asked.properties):
            broken.append("properties")
        return broken

    def broken_by_studies(self, place: Place) -> bool:
        """Say whether what is asked of studies is met neither by one of them nor by advice."""
        if not any(name.removeprefix(EXCLUDE) in OF_STUDIES for name in self._sets):
            return False
        if place.studies & self.studies:
            return False
        included = [name for name in OF_STUDIES if name in self.asked.include]
        if not included:
            return bool(place.studies)
        return not self.advised(place, included)

    def advised(self, place: Place, included: Sequence[str]) -> bool:
        """Say whether the survey advises an architecture for everything included."""
        return all(
            any(a.requirement == name and a.value in self.asked.include[name] for a in place.advice)
            for name in included
        )

    def broken_limits(self, row: Measured) -> list[str]:
        """Return the limits that a measured pipeline breaks."""
        judged = self.judged[row]
        broken = self._judged_by.broken(row, judged)
        largest = self.asked.max_error_deg
        if largest is not None and not judged.error_deg <= largest:
            broken.append("max_error_deg")
        return broken

    def stated(self, limit: str) -> int:
        """Return the studies (bits) whose stated number keeps a limit that is asked."""
        return self._stated[limit]

    def _kept(self, place: Place, best: Sequence[Kept]) -> tuple[Kept, ...]:
        """Return the designs that meet them: measured, the least error first; then stated."""
        largest = self.asked.max_error_deg
        if largest is not None:
            best = best[: bisect.bisect_right(best, largest, key=lambda kept: kept.error_deg)]
        stated = tuple(
            Kept(design, None, NOTHING)
            for design in place.unmeasured
            if design.taken & self._all_stated
        )
        both = (*best, *stated)
        if not self._of_design:
            return both
        return tuple(kept for kept in both if not self.broken_by_design(kept.design))

    def basis(self, place: Place, kept: Kept) -> dict[str, str]:
        """Say of each requirement whether it was judged on what is measured, stated, and so on."""
        basis = dict.fromkeys(self.limits, "stated" if kept.row is None else "measured")
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

    def _values(self, attribute: str, values: Iterable[str]) -> frozenset[str]:
        """Return values and their kinds."""
        taxonomy = self.table.facts.taxonomy
        return frozenset(kind for v in values for kind in taxonomy.kinds(attribute, v))

    def _stated_within(self, limit: str) -> int:
        if limit not in _STATED:
            return 0
        bound = self.asked.limit(limit)
        assert bound is not None  # noqa: S101 - only limits asked for are looked at
        numbers = self.table.stated[_STATED[limit]]
        return sum(
            1 << at
            for at, number in numbers
            if (number >= bound if limit == "min_fov_deg" else number <= bound)
        )
