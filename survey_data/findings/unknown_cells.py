"""How studies with unknown cells could count in a clause of a finding."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator

from survey_data.findings.completions import Possibility
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
