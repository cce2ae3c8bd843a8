"""Why nothing meets the requirements, and the least that must give way."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from registry.judging import REPORTED, Question
from registry.requirements import EXCLUDE, LIMITS, LISTS, Requirements
from survey_data.processors import factor

Value = tuple[str, ...] | float

MOST_CHANGES = 5
"""Changes of value offered for one requirement."""


@dataclass(frozen=True)
class Relaxation:
    """A change of the requirements that gives architectures, and how many.

    ``drop`` maps each requirement dropped to what it asked; ``change`` maps a requirement to what
    it would ask instead. One of them is empty.
    """

    drop: Mapping[str, Value]
    change: Mapping[str, Value]
    architectures: int

    @property
    def words(self) -> str:
        """What to do, in words."""
        if self.drop:
            return "drop " + " and ".join(in_words(*item) for item in self.drop.items())
        return "ask instead for " + " and ".join(in_words(*item) for item in self.change.items())


@dataclass(frozen=True)
class Explanation:
    """Why no architecture meets the requirements.

    ``constraints`` is the smallest set whose removal gives architectures again, at most two; of
    several as small the one that gives most. It is empty where no set of two does.
    """

    constraints: tuple[str, ...]
    detail: str
    relaxations: tuple[Relaxation, ...]


def explain(question: Question) -> Explanation:
    """Return what stands in the way of a question that nothing meets."""
    asked = question.requirements
    drops = _drops(question, 1) or _drops(question, 2)
    if not drops:
        detail = "nothing meets the requirements, nor does dropping any two of them help"
        return Explanation((), detail, ())
    first = tuple(drops[0].drop)
    changes = [one for drop in drops for one in _changes(question, drop)] if len(first) == 1 else []
    changes.sort(key=lambda one: -one.architectures)
    words = " and ".join(in_words(name, asked.value_of(name)) for name in first)
    beside = " beside the other requirements" if len(asked.names) > len(first) else ""
    count = drops[0].architectures
    detail = (
        f"nothing meets {words}{beside}; without {'it' if len(first) == 1 else 'them'} {count} "
        f"architecture{'s' * (count != 1)} would"
    )
    return Explanation(first, detail + _bench(question), (*drops, *changes))


_WORDS = {
    "max_error_deg": "an error of at most {:g} deg",
    "min_fov_deg": "a full field of view of at least {:g} deg",
    "min_availability": "an answer to at least {:g} of the samples",
    "max_latency_us": "at most {:g} us a sample",
    "max_mass_g": "at most {:g} g",
    "max_power_mw": "at most {:g} mW",
    "min_rate_hz": "at least {:g} updates a second",
    "sun_distance_au": "{:g} au from the Sun",
}


def in_words(name: str, asked: Value) -> str:
    """Return a requirement in words, with the values that the reader gave."""
    if not isinstance(asked, tuple):
        return _WORDS[name].format(asked)
    if name == "tolerate":
        return f"surviving {' and '.join(asked)}"
    if name == "exclude_needs":
        return f"no need of {' or '.join(asked)}"
    if name == "properties":
        return f"an extractor with {' and '.join(asked)}"
    if name.startswith(EXCLUDE):
        return f"no {name.removeprefix(EXCLUDE)} {' or '.join(asked)}"
    return f"{name} {' or '.join(asked)}"


def _drops(question: Question, size: int) -> list[Relaxation]:
    """Return every set of so many requirements whose removal helps, best first."""
    asked = question.requirements
    found = [
        Relaxation({name: asked.value_of(name) for name in names}, {}, count)
        for names in itertools.combinations(asked.names, size)
        if (count := _count(question, asked.without(*names)))
    ]
    return sorted(found, key=lambda one: -one.architectures)


def _changes(question: Question, drop: Relaxation) -> list[Relaxation]:
    """Return the values that the one requirement dropped could ask instead."""
    ((name, asked),) = drop.drop.items()
    found = [
        Relaxation({}, {name: value}, count)
        for value in _candidates(question, name, asked)
        if (count := _count(question, question.requirements.with_value(name, value)))
    ]
    found.sort(key=lambda one: -one.architectures)
    return found[:MOST_CHANGES]


def _candidates(question: Question, name: str, asked: Value) -> list[Value]:
    if name in LIMITS or not isinstance(asked, tuple):
        nearest = _nearest_limit(question, name)
        return [] if nearest is None else [nearest]
    if name in LISTS or name.startswith(EXCLUDE):
        return [kept for one in asked if (kept := tuple(v for v in asked if v != one))]
    return [(value,) for value in question.table.facts.taxonomy.values(name)]


def _nearest_limit(question: Question, name: str) -> float | None:
    """Return the strictest limit that is kept by what meets all else; None if there is none."""
    rest = Question(question.table, question.requirements.without(name))
    table = question.table
    if name == "min_fov_deg":
        reported = table.report_numbers["fov_deg"][rest.reported]
        fields = {*(2.0 * table.edges).tolist(), *reported[~np.isnan(reported)].tolist()}
        widest = sorted((one for one in fields if 0.0 < one <= 360.0), reverse=True)
        met = (w for w in widest if _count(question, question.requirements.with_value(name, w)))
        return next(met, None)
    values = []
    if name in REPORTED:
        values.append(table.report_numbers[REPORTED[name][0]][rest.reported])
    by_row = {
        "max_error_deg": rest.judged_deg,
        "min_availability": rest.errors.availability,
        "max_latency_us": table.latency_us * factor(rest.requirements.processor),
    }
    if name in by_row:
        values.append(by_row[name][rest.measured])
    known = np.concatenate([np.zeros(0), *values])
    known = known[np.isfinite(known) & (known > 0.0)]
    if not len(known):
        return None
    return float(known.max() if name.startswith("min_") else known.min())


def _bench(question: Question) -> str:
    """Return, where the stated bench stands in the way, how good it must be."""
    asked = question.requirements
    if asked.bench_deg is None or asked.largest_deg is None:
        return ""
    without = Question(question.table, replace(asked, bench_deg=None))
    needed = without.bench_for(np.flatnonzero(without.measured).tolist())
    if not needed:
        return ""
    return (
        f". The calibration bench of {asked.bench_deg:g} deg stands in the way: one good to "
        f"{needed:g} deg would do"
    )


def _count(question: Question, requirements: Requirements) -> int:
    return int(np.count_nonzero(Question(question.table, requirements).matching_places))
