"""Why nothing meets the requirements, and the least that must give way."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Context
from types import MappingProxyType
from typing import TYPE_CHECKING

from registry.designs import DesignTable
from registry.judging import OF_STUDIES, Question
from registry.paths import positions
from registry.requirements import EXCLUDE, LIMITS, LISTS, Requirements

if TYPE_CHECKING:
    from registry.design_arrays import DesignArrays, Flags

MOST_CHANGES = 5
"""Changes of value offered for one categorical constraint."""

MOST_SETS = 10
"""Sets of constraints to drop offered where one alone does not help."""


@dataclass(frozen=True)
class Relaxation:
    """A change of the requirements that gives architectures, and how many.

    ``drop`` maps each constraint dropped to what it asked; ``change`` maps a constraint to what it
    would ask instead. One of them is empty.
    """

    drop: Mapping[str, tuple[str, ...] | float]
    change: Mapping[str, tuple[str, ...] | float]
    architectures: int

    @property
    def words(self) -> str:
        """What to do, in words."""
        if self.drop:
            return "drop " + " and ".join(in_words(*item) for item in self.drop.items())
        return "ask instead for " + " and ".join(in_words(*item) for item in self.change.items())

    @property
    def constraint(self) -> str:
        """The constraints concerned, joined by " + "."""
        return " + ".join((*self.drop, *self.change))

    def apply(self, requirements: Requirements) -> Requirements:
        """Return the requirements relaxed so."""
        relaxed = requirements.without(*self.drop)
        for name, value in self.change.items():
            relaxed = relaxed.with_value(name, value)
        return relaxed

    def to_dict(self) -> dict[str, object]:
        """Return the relaxation as in the HTTP answer: `drop` or `change`, whichever it is."""
        asked = self.drop or self.change
        return {
            "constraint": self.constraint,
            "drop" if self.drop else "change": {
                n: list(v) if isinstance(v, tuple) else v for n, v in asked.items()
            },
            "architectures": self.architectures,
            "words": self.words,
        }


@dataclass(frozen=True)
class BlockingConstraint:
    """The constraint that killed every design.

    ``constraints`` is the smallest set whose removal gives architectures again; of several as
    small the one that gives most, then the first in the order of
    `registry.requirements.PARAMETERS`. It is empty only if there are no designs at all.
    ``relaxations`` lists every set as small and, where one constraint alone is to blame, the
    values it could ask instead; of the field of view whenever it is asked.
    """

    constraints: tuple[str, ...]
    detail: str
    relaxations: tuple[Relaxation, ...]

    @property
    def constraint(self) -> str:
        """The constraints joined by " + "."""
        return " + ".join(self.constraints)

    def to_dict(self) -> dict[str, object]:
        """Return the explanation as in the HTTP answer."""
        return {
            "constraint": self.constraint,
            "detail": self.detail,
            "relaxations": [relaxation.to_dict() for relaxation in self.relaxations],
        }


def explain(question: Question) -> BlockingConstraint:
    """Return what blocks the requirements of a question that nothing meets."""
    table, requirements = question.table, question.requirements
    names = requirements.names
    broken = _broken_sets(question, names)
    if not broken:
        return BlockingConstraint((), "no study has an architecture, and nothing is measured", ())
    fewest = min(bits.bit_count() for bits in broken)
    smallest = sorted(bits for bits in broken if bits.bit_count() == fewest)
    drops = []
    for bits in smallest:
        dropped = tuple(names[at] for at in positions(bits))
        found = _count(table, requirements.without(*dropped))
        drops.append(Relaxation({n: _ask(requirements, n) for n in dropped}, {}, found))
    drops.sort(key=lambda r: (-r.architectures, [names.index(n) for n in r.drop]))
    changed = [name for relaxation in drops for name in relaxation.drop] if fewest == 1 else []
    if "min_fov_deg" in names and "min_fov_deg" not in changed:
        # Over a narrower field the error is less; over none in particular it is the whole field's.
        changed.append("min_fov_deg")
    changes = [one for name in changed for one in _changes(table, requirements, name)]
    changes.sort(key=lambda r: -r.architectures)
    first = tuple(drops[0].drop)
    asked = " and ".join(in_words(n, _ask(requirements, n)) for n in first)
    others = len(names) - len(first)
    detail = (
        f"nothing meets {asked}{' beside the other requirements' if others else ''}; without "
        f"{'it' if len(first) == 1 else 'them'} {drops[0].architectures} "
        f"architecture{'s' * (drops[0].architectures != 1)} would"
    )
    unknown = [n for n in first if not _has_evidence(question, n)]
    if unknown:
        words = " or ".join(in_words(n, _ask(requirements, n)) for n in unknown)
        detail += f". Nothing measured or stated tells of {words}"
    if bench := _bench_that_would_do(table, requirements):
        worth = _TWO_DIGITS.create_decimal(bench)  # rounded down: a worse bench would not do
        detail += f". A calibration bench good to {float(worth):g} deg would do"
    return BlockingConstraint(first, detail, (*drops[:MOST_SETS], *changes))


_TWO_DIGITS = Context(prec=2, rounding=ROUND_FLOOR)
_WORDS = {
    "max_error_deg": "an error of at most {:g} deg",
    "min_fov_deg": "a full field of view of at least {:g} deg",
    "min_availability": "an answer to at least {:g} of the samples",
    "max_latency_us": "at most {:g} us a sample",
}


def in_words(name: str, asked: tuple[str, ...] | float) -> str:
    """Return a requirement in words, with the values that the reader gave."""
    if not isinstance(asked, tuple):
        return _WORDS[name].format(asked)
    if name == "survive":
        return f"surviving {' and '.join(asked)}"
    if name == "exclude_needs":
        return f"no need of {' or '.join(asked)}"
    if name == "properties":
        return f"an extractor with {' and '.join(asked)}"
    values = " or ".join(asked)
    if name.startswith(EXCLUDE):
        return f"no {name.removeprefix(EXCLUDE)} {values}"
    return f"{name} {values}"


_TOGETHER = ("max_error_deg", "min_fov_deg", "survive", "min_availability")
"""Limits of which one changes how another is judged: an error holds over a field and conditions."""


def _broken_sets(question: Question, names: tuple[str, ...]) -> frozenset[int]:
    """Return, of every way to a design, the requirements it breaks as bits over `names`.

    A way is a design, one of its measured pipelines if there are any, and one of the studies of
    its architecture, or the survey's advice: a design meets a subset of the requirements exactly
    if one of its ways breaks none of them. Where requirements are judged together, a way is also
    a choice of those that are given up.
    """
    bit = {name: 1 << at for at, name in enumerate(names)}
    arrays = question.arrays
    by_study = _broken_by_studies(question, names, bit)
    by_design = arrays.broken_requirements(
        {bit[name]: has for name, has in question.designs_with.items()}
    )
    by_row = arrays.broken_by_place(by_design, _broken_by_rows(question, bit))
    by_study_and_limit = by_study
    for name in question.limits:
        by_study_and_limit = _split(by_study_and_limit, bit[name], question.studies_within(name))
    included = [n for n in OF_STUDIES if n in question.requirements.include]
    found: set[int] = set()
    for number, place in enumerate(question.table.places):
        ways = {bits for bits, studies in by_study.items() if studies & place.studies}
        unadvised = [n for n in included if not question.is_advised(place, [n])]
        # Advice speaks for what is asked for; of what is excluded only studies tell.
        if len(unadvised) < len(included):
            ways.add(sum(bit[n] for n in unadvised))
        if not place.studies:
            ways.add(sum(bit[n] for n in included))
        found.update(bits | way for bits in by_row[number] for way in ways)
    for design_at in arrays.unmeasured_designs.tolist():
        bits, users = int(by_design[design_at]), arrays.designs[design_at].users
        found.update(bits | way for way, studies in by_study_and_limit.items() if studies & users)
    return frozenset(found)


def _broken_by_rows(question: Question, bit: Mapping[str, int]) -> list[tuple[int, Flags]]:
    """Return sets of limits that may be given up, and which measured pipelines then keep the rest.

    Of each pipeline the smallest sets. What is left is judged without what is given up.
    """
    asked, arrays = question.requirements, question.arrays
    # A class of accuracy is a limit on what is measured, too.
    alone = asked.without(*(n for n in asked.names if n not in (*_TOGETHER, "accuracy")))
    found: list[tuple[int, Flags]] = []
    for size in range(len(alone.names) + 1):
        for dropped in itertools.combinations(alone.names, size):
            given_up = sum(bit[n] for n in dropped)
            keeping = _within_limits(arrays, alone.without(*dropped))
            for less, kept in found:
                if given_up & less == less:
                    keeping = keeping & ~kept  # less is enough
            found.append((given_up, keeping))
    if asked.max_latency_us is not None:
        slow = ~(arrays.latency_us <= asked.max_latency_us)
        also = bit["max_latency_us"]
        found = [
            part
            for bits, kept in found
            for part in ((bits, kept & ~slow), (bits | also, kept & slow))
        ]
    return found


def _within_limits(arrays: DesignArrays, asked: Requirements) -> Flags:
    """Say of each measured pipeline whether it keeps all limits asked for."""
    limits = Question.limits_of(asked)
    judged = arrays.errors(limits.hazards, limits.half_field_deg, limits.draws)
    return judged.within_limits(limits, asked.largest_deg)


def _broken_by_studies(
    question: Question, names: tuple[str, ...], bit: Mapping[str, int]
) -> dict[int, int]:
    """Return the studies (bits) by the set that they break of what is asked of studies.

    A task asked for and one excluded are judged together: one of its tasks must be asked for and
    not excluded. So a study may have several sets.
    """
    asked = [n for n in names if n.removeprefix(EXCLUDE) in OF_STUDIES]
    tasks = [n for n in asked if n.removeprefix(EXCLUDE) == "task"]
    broken: dict[int, int] = {}
    for size in range(len(tasks) + 1):
        for dropped in itertools.combinations(tasks, size):
            given_up = sum(bit[n] for n in dropped)
            matching = _studies_with(question, [n for n in tasks if n not in dropped])
            for less, studies in broken.items():
                if given_up & less == less:
                    matching &= ~studies  # less is enough
            broken[given_up] = matching
    for name in asked:
        if name not in tasks:
            broken = _split(broken, bit[name], _studies_with(question, [name]))
    return broken


def _split(broken: Mapping[int, int], bit: int, matching: int) -> dict[int, int]:
    """Add a requirement to the sets of those studies that do not match it."""
    parts = [(bits, studies & matching) for bits, studies in broken.items()]
    parts += [(bits | bit, studies & ~matching) for bits, studies in broken.items()]
    return {bits: studies for bits, studies in parts if studies}


def _studies_with(question: Question, names: Collection[str]) -> int:
    """Return the studies (bits) that meet some of the requirements alone."""
    return Question(question.table, _only(question.requirements, names)).studies


def _only(requirements: Requirements, names: Collection[str]) -> Requirements:
    """Return some of the requirements alone."""
    return requirements.without(*(other for other in requirements.names if other not in names))


def _count(table: DesignTable, requirements: Requirements) -> int:
    return Question(table, requirements).count()


def _changes(table: DesignTable, requirements: Requirements, name: str) -> list[Relaxation]:
    """Return the values one constraint could ask instead, each with what it gives."""
    candidates: list[tuple[str, ...] | float]
    asked = _ask(requirements, name)
    if name in LIMITS:
        nearest = _nearest_limit(table, requirements.without(name), name)
        candidates = [] if nearest is None else [nearest]
    elif name.startswith(EXCLUDE) or name in LISTS:
        assert isinstance(asked, tuple)  # noqa: S101 - only limits are numbers
        candidates = [tuple(v for v in asked if v != w) for w in asked]
        candidates = [kept for kept in candidates if kept]  # none left is dropping it
    else:
        candidates = [(v,) for v in table.facts.taxonomy.values(name)]
    changes = []
    for value in candidates:
        found = _count(table, requirements.with_value(name, value))
        if found:
            changes.append(Relaxation({}, MappingProxyType({name: value}), found))
    changes.sort(key=lambda r: -r.architectures)
    return changes[:MOST_CHANGES]


def _nearest_limit(table: DesignTable, requirements: Requirements, limit: str) -> float | None:
    """Return the strictest bound on `limit` that is kept by what meets all else; None if none."""
    if limit == "min_fov_deg":
        return _widest(table, requirements)
    question = Question(table, requirements)
    arrays = question.arrays
    rows = question.matching_designs[arrays.design_of] & _within_limits(arrays, requirements)
    values = {
        "max_error_deg": question.errors.error_deg,
        "min_availability": question.errors.availability,
        "max_latency_us": arrays.latency_us,
    }[limit][rows]
    numbers: list[float] = values[(values > 0.0) & (values < math.inf)].tolist()
    if limit == "max_error_deg":
        numbers += _stated_numbers(question, "accuracy_deg")
    if not numbers:
        return None
    return max(numbers) if limit.startswith("min_") else min(numbers)


def _stated_numbers(question: Question, attribute: str) -> list[float]:
    """Return a number stated by the studies behind the designs of an answer not measured."""
    designs = question.arrays.designs
    bits = 0
    for at in question.arrays.unmeasured_designs.tolist():
        if not question.matching_designs[at]:
            continue
        bits |= designs[at].users
    bits &= question.studies_within_limits
    return [number for at, number in question.table.stated_numbers[attribute] if bits >> at & 1]


def _widest(table: DesignTable, requirements: Requirements) -> float | None:
    """Return the widest field that something has which meets all else over that field."""
    # What is judged over the field is left to the rows.
    rest = Question(table, requirements.without(*_TOGETHER))
    arrays = rest.arrays
    rows = rest.matching_designs[arrays.design_of]
    widest = 0.0
    for half, has_error in arrays.cone_edges:
        among = rows & has_error
        if not among.any():
            continue
        over = requirements.with_value("min_fov_deg", 2.0 * half)
        if (among & _within_limits(arrays, over)).any():
            widest = 2.0 * half
            break
    return max(widest, *_stated_numbers(Question(table, requirements), "fov_deg"), 0.0) or None


def _bench_that_would_do(table: DesignTable, requirements: Requirements) -> float | None:
    """Return the fixed error of a bench with which something would meet all; None for nothing."""
    limit, draws = requirements.largest_deg, requirements.draws
    if limit is None or draws is None:
        return None
    from registry.draws import largest_bench  # noqa: PLC0415 - NumPy

    question = Question(table, replace(requirements, bench_deg=0.0))
    rows = question.matching_designs[question.arrays.design_of]
    rows &= _within_limits(question.arrays, question.requirements)
    if not rows.any():
        return None
    ratios = question.arrays.unit_ratios[rows]
    return largest_bench(question.errors.own_deg[rows], ratios, limit, draws[1])


def _has_evidence(question: Question, name: str) -> bool:
    """Say whether anything measured or stated tells of a requirement at all."""
    arrays, stated_numbers = question.arrays, question.table.stated_numbers
    if name == "max_latency_us":
        return bool((arrays.latency_us < math.inf).any())
    if name == "min_availability":
        return bool(arrays.rows)
    if name == "survive":
        return all(bool(arrays.covers(hazard).any()) for hazard in question.requirements.survive)
    if name == "max_error_deg":
        return bool(arrays.rows or stated_numbers["accuracy_deg"])
    if name == "min_fov_deg":
        return bool(arrays.rows or stated_numbers["fov_deg"])
    return True


def _ask(requirements: Requirements, name: str) -> tuple[str, ...] | float:
    """Return what is asked of one of the requirements' own names."""
    asked = requirements.value_of(name)
    if asked is None:
        raise KeyError(name)
    return asked
