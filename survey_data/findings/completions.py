"""How studies with unknown cells could count, and how few of them could make a clause hold."""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from survey_data.findings.evidence import (
    FIRST_OF_SEVERAL,
    LEAST_COUNTED,
    NO_MAJORITY,
    OCCURRING,
    Tally,
)
from survey_data.findings.grammar import (
    CATEGORY_OF,
    CENTROID_FAMILY,
    PAIR,
    Clause,
    Entry,
    Vocabulary,
    accepted,
    passes,
)

Values = frozenset[str]


@dataclass(frozen=True)
class Possibility:
    """How a study with an unknown cell could count in a clause, or not at all.

    ``choices`` are values that it would be counted for, ``several`` whether for several of them at
    once; it passes the filter with one of each of the ``required`` places of choices only.
    """

    choices: tuple[Values, ...]
    several: bool
    required: tuple[tuple[int, ...], ...] = ()


def fewest_to_hold(tally: Tally, possibilities: Iterable[Possibility]) -> int | None:
    """Return how few studies' unknown cells could make a clause hold; None if none could.

    An integer linear programme: how many of the studies that are alike take each choice, the fewest
    of them, so that the counts rank as the clause says. `possibilities` has one for each study that
    has a cell unknown which the clause asks for.
    """
    groups = Counter(possibilities)
    firsts = [[value] for value in tally.named]
    wanted = firsts if tally.kind in FIRST_OF_SEVERAL else [list(tally.named)]
    found = [_fewest(tally, named, groups) for named in wanted]
    return min((few for few in found if few is not None), default=None)


class _Programme:
    """Rows and columns of an integer linear programme over studies, choices and counts."""

    def __init__(self, tally: Tally, groups: Mapping[Possibility, int]) -> None:
        self.cost: list[float] = []
        self.upper: list[float] = []
        self.rows: list[tuple[dict[int, float], float]] = []  # sum of terms at least a bound
        self.added: dict[str, dict[int, float]] = {}
        self.counted: dict[int, float] = {}
        for one, studies in groups.items():
            taken = self.variable(studies, cost=1.0)
            self.counted[taken] = 1.0
            each = [self.variable(studies) for _ in one.choices]
            for at in each:
                self.rows.append(({taken: 1.0, at: -1.0}, 0.0))
            for value in sorted(frozenset().union(*one.choices)):
                holding = [at for at, c in zip(each, one.choices, strict=True) if value in c]
                self._count(value, taken, holding, studies)
            for places in (tuple(range(len(each))), *one.required):
                some = dict.fromkeys((each[place] for place in places), 1.0)
                self.rows.append(({**some, taken: -1.0}, 0.0))
            if not one.several:
                self.rows.append(({**dict.fromkeys(each, -1.0), taken: 1.0}, 0.0))
        self.most = tally.counted + sum(groups.values()) + 1.0
        self.base = {**tally.others, **tally.named}

    def variable(self, upper: float, cost: float = 0.0) -> int:
        """Add a whole number from 0 to a bound; returns its column."""
        self.cost.append(cost)
        self.upper.append(upper)
        return len(self.cost) - 1

    def _count(self, value: str, taken: int, holding: Sequence[int], studies: int) -> None:
        """Count each study once for a value, however many of its choices hold it."""
        once = self.variable(studies)
        self.added.setdefault(value, {})[once] = 1.0
        self.rows.append(({taken: 1.0, once: -1.0}, 0.0))
        self.rows.append(({**dict.fromkeys(holding, 1.0), once: -1.0}, 0.0))
        self.rows += [({once: 1.0, at: -1.0}, 0.0) for at in holding]

    def above(self, first: str, second: str | None, by: float, switch: int | None = None) -> None:
        """Require a value's count to exceed another's (None: zero), if a switch is on."""
        terms = dict(self.added.get(first, {}))
        bound = by - self.base.get(first, 0)
        if second is not None:
            for at in self.added.get(second, {}):
                terms[at] = terms.get(at, 0.0) - 1.0
            bound += self.base.get(second, 0)
        if switch is not None:
            terms[switch] = -self.most
            bound -= self.most
        self.rows.append((terms, bound))

    def solve(self) -> int | None:
        """Return the smallest cost; None where nothing keeps all rows."""
        from scipy.optimize import Bounds, LinearConstraint, milp  # noqa: PLC0415 - SciPy, at the first use

        if not self.cost:
            return None
        matrix = np.zeros((len(self.rows), len(self.cost)))
        for at, (terms, _) in enumerate(self.rows):
            matrix[at, list(terms)] = list(terms.values())
        found = milp(
            self.cost,
            constraints=LinearConstraint(matrix, [bound for _, bound in self.rows], np.inf),
            integrality=np.ones(len(self.cost), dtype=np.int64),
            bounds=Bounds(np.zeros(len(self.cost)), np.asarray(self.upper)),
        )
        return round(found.fun) if found.success else None


def _fewest(tally: Tally, named: list[str], groups: Mapping[Possibility, int]) -> int | None:
    programme = _Programme(tally, groups)
    values = {*programme.base, *programme.added}
    others = sorted(values - set(tally.named))
    programme.rows.append((programme.counted, LEAST_COUNTED - tally.counted))
    if tally.kind == NO_MAJORITY:
        for value in named:
            twice = {at: -2.0 * n for at, n in programme.added.get(value, {}).items()}
            bound = 2.0 * tally.named[value] - tally.counted
            programme.rows.append(({**programme.counted, **twice}, bound))
        return programme.solve()
    for value in named:
        programme.above(value, None, 1.0)
    if tally.kind not in OCCURRING:
        for first, second in _pairs(tally.kind, named, others):
            rare = tally.kind.startswith("bottom")
            programme.above(first, second, 1.0, _occurs(programme, first) if rare else None)
    return programme.solve()


def _pairs(kind: str, named: list[str], others: list[str]) -> Iterator[tuple[str, str]]:
    """Yield pairs of values of which the first must have more studies."""
    if kind.startswith("bottom"):
        yield from ((other, value) for other in others for value in named)
        return
    if kind == "order":
        yield from itertools.pairwise(named)
    for value in named[-1:] if kind == "order" else named:
        yield from ((value, other) for other in others)


def _occurs(programme: _Programme, value: str) -> int:
    """Add a switch that is on where a value occurs in a study."""
    switch = programme.variable(1.0)
    off = {at: -n for at, n in programme.added.get(value, {}).items()}
    programme.rows.append(({**off, switch: programme.most}, float(programme.base.get(value, 0))))
    return switch


def possibilities(
    clause: Clause, entries: Iterable[Entry], vocabulary: Vocabulary
) -> Iterator[Possibility]:
    """Yield what each study could add to a clause's counts by cells that are not known."""
    for entry in entries:
        unsettled = [one for one in clause.given if one[0] not in entry]
        settled = [one for one in clause.given if one[0] in entry]
        if not passes(entry, settled) or _contradicting(unsettled, vocabulary):
            continue
        if clause.ranked not in entry:
            yield _open(clause, entry, dict(unsettled), vocabulary)
        elif unsettled:
            known = _counted(clause, entry[clause.ranked], vocabulary)
            yield Possibility((known,), several=False)


def _contradicting(conditions: list[tuple[str, tuple[str, ...]]], vocabulary: Vocabulary) -> bool:
    """Say whether one value cannot keep all conditions on an attribute that has one at most."""
    left: dict[str, frozenset[str]] = {}
    for name, values in conditions:
        allowed = accepted(name, values)
        left[name] = left.get(name, allowed) & allowed if name in vocabulary.single else allowed
    return not all(left.values())


def _open(
    clause: Clause, entry: Entry, unsettled: dict[str, tuple[str, ...]], vocabulary: Vocabulary
) -> Possibility:
    """Return the possibilities of a study whose ranked value is not known."""
    base = CATEGORY_OF.get(clause.ranked, clause.ranked)
    parts = base.split("+") if clause.ranked == PAIR else [base]
    lists = [sorted(entry.get(part, vocabulary.values.get(part, ()))) for part in parts]
    cells = list(itertools.product(*lists))
    if clause.ranked == PAIR:
        # several detectors of a study go with each of its masks, as they are counted
        held = [part for part in parts if part in entry]
        grouped: dict[tuple[str, ...], list[tuple[str, ...]]] = {}
        for cell in cells:
            key = tuple(v for part, v in zip(parts, cell, strict=True) if part not in held)
            grouped.setdefault(key, []).append(cell)
        choices = list(grouped.values())
    else:
        choices = [[cell] for cell in cells]
    required = tuple(
        tuple(
            place
            for place, choice in enumerate(choices)
            if any(cell[at] in accepted(part, unsettled[part]) for cell in choice)
        )
        for at, part in enumerate(parts)
        if part in unsettled
    )
    names = [
        frozenset(
            vocabulary.category[base, cell[0]] if clause.ranked in CATEGORY_OF else "+".join(cell)
            for cell in choice
        )
        for choice in choices
    ]
    return Possibility(
        tuple(_counted(clause, one, vocabulary) for one in names),
        several=not set(parts) & vocabulary.single,
        required=required,
    )


def _counted(clause: Clause, values: Iterable[str], vocabulary: Vocabulary) -> frozenset[str]:
    """Return the values that a study is counted for."""
    if clause.kind == "top-centroid":
        values = [v for v in values if vocabulary.category["extractor", v] == CENTROID_FAMILY]
    return clause.as_named(values)
