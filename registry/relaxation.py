"""Why no path meets the requirements, and the least that must give way."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from registry.measured import Measurements
from registry.paths import (
    PATH_LEVELS,
    PathTable,
    measured_number,
    positions,
    within,
)
from registry.requirements import EXCLUDE, LIMITS, Requirements
from registry.taxonomy import ATTRIBUTES

MOST_CHANGES = 5
"""Changes of value offered for one categorical constraint."""

MOST_SETS = 10
"""Sets of constraints to drop offered where one alone does not help."""


@dataclass(frozen=True)
class Relaxation:
    """A change of the requirements that gives paths, and how many.

    ``drop`` maps each constraint dropped to what it asked; ``change`` maps a constraint to what it
    would ask instead. One of them is empty.
    """

    drop: Mapping[str, tuple[str, ...] | float]
    change: Mapping[str, tuple[str, ...] | float]
    paths: int

    @property
    def constraint(self) -> str:
        """The constraints concerned, joined by " + "."""
        return " + ".join((*self.drop, *self.change))

    def apply(self, requirements: Requirements) -> Requirements:
        """Return the requirements relaxed so."""
        relaxed = requirements.without(*self.drop)
        for name, value in self.change.items():
            relaxed = relaxed.changed(name, value)
        return relaxed

    def to_dict(self) -> dict[str, object]:
        """Return the relaxation as in the HTTP answer: `drop` or `change`, whichever it is."""
        asked = self.drop or self.change
        return {
            "constraint": self.constraint,
            "drop" if self.drop else "change": {
                n: list(v) if isinstance(v, tuple) else v for n, v in asked.items()
            },
            "paths": self.paths,
        }


@dataclass(frozen=True)
class Blocked:
    """The constraint that killed every path.

    ``constraints`` is the smallest set whose removal gives paths again; of several as small the
    one that gives most, then the first in the order of `registry.requirements.PARAMETERS`. It is
    empty only if there are no paths at all. ``relaxations`` lists every set as small and, where
    one constraint alone is to blame, the values it could ask instead.
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


def explain(table: PathTable, requirements: Requirements, measurements: Measurements) -> Blocked:
    """Return what blocks `requirements`, which no path meets."""
    names = requirements.names
    broken = set(_broken(table, requirements, measurements, names))
    if not broken:
        return Blocked((), "no study has a value at every level of a path", ())
    fewest = min(bits.bit_count() for bits in broken)
    smallest = sorted(bits for bits in broken if bits.bit_count() == fewest)
    drops = []
    for bits in smallest:
        dropped = tuple(names[at] for at in positions(bits))
        paths = len(table.meeting(requirements.without(*dropped), measurements))
        drops.append(Relaxation({n: _asked(requirements, n) for n in dropped}, {}, paths))
    drops.sort(key=lambda r: (-r.paths, [names.index(n) for n in r.drop]))
    changes: list[Relaxation] = []
    if fewest == 1:
        for relaxation in drops:
            (name,) = relaxation.drop
            changes += _changes(table, requirements, measurements, name)
    changes.sort(key=lambda r: -r.paths)
    first = tuple(drops[0].drop)
    asked = " and ".join(f"{n} = {_shown(_asked(requirements, n))}" for n in first)
    others = len(names) - len(first)
    detail = (
        f"no path meets {asked}{' beside the other requirements' if others else ''}; without "
        f"{'it' if len(first) == 1 else 'them'} {drops[0].paths} would"
    )
    unmeasured = [n for n in first if n in LIMITS and not _has_evidence(table, measurements, n)]
    if unmeasured:
        detail += f". Nothing measured or stated tells of {' or '.join(unmeasured)}"
    return Blocked(first, detail, (*drops[:MOST_SETS], *changes))


def _broken(
    table: PathTable,
    requirements: Requirements,
    measurements: Measurements,
    names: tuple[str, ...],
) -> Iterator[int]:
    """Yield, for every way to take a path, the requirements it breaks as bits over `names`.

    A way is a path, one of its studies, and one of its measured rows if there are any: a path
    meets a subset of the requirements exactly if one of its ways breaks none of them.
    """
    bit = {name: 1 << at for at, name in enumerate(names)}
    sets: dict[str, int] = {}  # constraint -> the paths, or studies, that keep it
    for attribute in ATTRIBUTES:
        find = table.any_path if attribute in PATH_LEVELS else table.any_study
        if attribute in bit:
            sets[attribute] = find(attribute, requirements.include[attribute])
        if EXCLUDE + attribute in bit:
            sets[EXCLUDE + attribute] = ~find(attribute, requirements.exclude[attribute])
    on_path = [n for n in sets if n.removeprefix(EXCLUDE) in PATH_LEVELS]
    on_study = [n for n in sets if n not in on_path]
    limits = [(n, bound) for n in LIMITS if (bound := requirements.limit(n)) is not None]
    stated = {n: table.stated_within(n, bound) for n, bound in limits}
    by_study = [
        sum(bit[n] for n in on_study if not sets[n] >> at & 1) for at in range(len(table.keys))
    ]
    for at in range(len(table.paths)):
        by_path = sum(bit[n] for n in on_path if not sets[n] >> at & 1)
        rows = measurements.on(table.routes[at]) or (None,)
        for study in positions(table.sets[at][2]):
            for row in rows:
                by_limit = 0
                for name, bound in limits:
                    number = None if row is None else measured_number(name, row)
                    kept = (
                        bool(stated[name] >> study & 1)
                        if number is None
                        else within(name, number, bound)
                    )
                    by_limit |= 0 if kept else bit[name]
                yield by_path | by_study[study] | by_limit


def _changes(
    table: PathTable, requirements: Requirements, measurements: Measurements, name: str
) -> list[Relaxation]:
    """Return the values one constraint could ask instead, each with the paths it gives."""
    candidates: list[tuple[str, ...] | float]
    if name in LIMITS:
        nearest = _nearest_limit(table, requirements.without(name), measurements, name)
        candidates = [] if nearest is None else [nearest]
    elif name.startswith(EXCLUDE):
        excluded = requirements.exclude[name.removeprefix(EXCLUDE)]
        candidates = [tuple(v for v in excluded if v != w) for w in excluded]
        candidates = [kept for kept in candidates if kept]  # none left is dropping it
    else:
        candidates = [(v,) for v in table.taxonomy.values(name)]
    changes = []
    for value in candidates:
        paths = len(table.meeting(requirements.changed(name, value), measurements))
        if paths:
            changes.append(Relaxation({}, MappingProxyType({name: value}), paths))
    changes.sort(key=lambda r: -r.paths)
    return changes[:MOST_CHANGES]


def _nearest_limit(
    table: PathTable, requirements: Requirements, measurements: Measurements, limit: str
) -> float | None:
    """Return the strictest bound on `limit` that the paths meeting all else keep; None if none."""
    numbers: list[float] = []
    studies = table.meeting_studies(requirements)
    others = [(n, bound) for n in LIMITS if (bound := requirements.limit(n)) is not None]
    stated = {n: table.stated_within(n, bound) for n, bound in others}
    for at in positions(table.meeting_paths(requirements)):
        for row in measurements.on(table.routes[at]) or (None,):
            kept = table.sets[at][2] & studies
            for name, bound in others:
                number = None if row is None else measured_number(name, row)
                if number is None:
                    kept &= stated[name]
                elif not within(name, number, bound):
                    kept = 0
            if not kept:
                continue
            number = None if row is None else measured_number(limit, row)
            if number is not None:
                numbers += [number] if math.isfinite(number) else []
            else:
                told = (table.numbers[limit][study] for study in positions(kept))
                numbers += [n for n in told if n is not None]
    if not numbers:
        return None
    return max(numbers) if limit.startswith("min_") else min(numbers)


def _has_evidence(table: PathTable, measurements: Measurements, limit: str) -> bool:
    return any(number is not None for number in table.numbers[limit]) or any(
        measured_number(limit, row) is not None
        for route in table.routes
        for row in measurements.on(route)
    )


def _asked(requirements: Requirements, name: str) -> tuple[str, ...] | float:
    asked = requirements.asked(name)
    if asked is None:
        raise ValueError(f"{name} asks nothing")
    return asked


def _shown(value: tuple[str, ...] | float) -> str:
    return " or ".join(value) if isinstance(value, tuple) else f"{value:g}"
