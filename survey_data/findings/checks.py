"""The findings' grammar, and how the tables answer them.

A finding has clauses, each of which is tested by itself. A clause filters the studies (`given`:
attribute=value joined by ``&``), ranks an attribute over them by the number of studies a value
occurs in, and says how named values rank (`expects`, `kind`). Values joined by `` or `` are
counted as one: a study with either counts once. Verdicts of clauses are strict: ``reproduced``,
``tied`` (it would hold if an equal count did not stand in its way), ``contradicted``, or
``undecidable`` where fewer than three studies that pass the filter have a known value of the
ranked attribute. A named value that occurs in no study fails.

A finding is ``reproduced`` where every clause is, ``partly`` where some are and others not, and
else ``contradicted``, ``tied`` or ``undecidable``, the first of these that a clause is.

- ``top``: the most frequent value is one of those named.
- ``top-set``: the named values are the most frequent, every one above all others.
- ``order``: the same, falling in the order given.
- ``bottom``, ``bottom-set``: every named value is below all others that occur.
- ``among``, ``spread``: every named value occurs.
- ``top-centroid``: as ``top``, within the category Centroid detection.
- ``no-majority``: no named value occurs in more than half of the studies counted.

``PD`` in a filter includes ``QPD``. Ranked besides attributes: ``detector+mask`` (pairs of a sensor
of the study), ``model_category`` and ``extractor_family`` (the taxonomy's categories), ``year``.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import pandas as pd

from files.json_data import JsonData
from survey_data import labels
from survey_data.findings.evidence import NO_MAJORITY, OCCURRING, Tally, settled_by

Verdict = Literal["reproduced", "partly", "tied", "contradicted", "undecidable"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "partly", "tied", "contradicted", "undecidable")
Values = Mapping[str, Mapping[str, frozenset[str]]]  # study -> attribute -> values

KINDS = (
    *("top", "top-set", "order", "bottom", "bottom-set", "among", "spread", "top-centroid"),
    NO_MAJORITY,
)
_CENTROID_FAMILY = "Centroid detection"
_INCLUDES = {("detector", "PD"): frozenset({"PD", "QPD"})}
_CATEGORY_OF = {"model_category": "model", "extractor_family": "extractor"}
_PAIR = "detector+mask"
_EITHER = " or "


class FindingSyntaxError(ValueError):
    """A clause of a finding does not keep the grammar; `column` names the cell."""

    def __init__(self, column: str, message: str) -> None:
        self.column = column
        super().__init__(message)


@dataclass(frozen=True)
class Clause:
    """One clause, parsed: filter conditions, ranked attribute and expected values."""

    kind: str
    given: tuple[tuple[str, tuple[str, ...]], ...]
    ranked: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class ClauseVerdict(JsonData):
    """A clause's verdict and the counts behind it.

    `matching` studies pass the filter, `counted` of them have a known value of the ranked
    attribute; `ranking` is (value, number of studies), most frequent first, ties by name; `named`
    the same of the values that the clause names. `settled_by` says on which counts the verdict
    rests, and which evidence would turn or decide it.
    """

    clause: int
    verdict: Verdict
    statement: str
    given: str
    expects: str
    kind: str
    matching: int
    counted: int
    ranking: tuple[tuple[str, int], ...]
    named: tuple[tuple[str, int], ...]
    settled_by: str


@dataclass(frozen=True)
class FindingVerdict:
    """A finding's verdict, made of its clauses'; `not_tested` is what none of them tests."""

    id: str
    verdict: Verdict
    survey_section: str
    statement: str
    not_tested: str
    clauses: tuple[ClauseVerdict, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict as plain JSON data."""
        return {
            "id": self.id,
            "verdict": self.verdict,
            "survey_section": self.survey_section,
            "section_name": labels.name(self.survey_section),
            "statement": self.statement,
            "not_tested": self.not_tested,
            "clauses": [clause.to_dict() for clause in self.clauses],
        }


def finding_verdict(clauses: Iterable[Verdict]) -> Verdict:
    """Return the verdict of a finding from those of its clauses."""
    found = set(clauses)
    if found == {"reproduced"}:
        return "reproduced"
    if "reproduced" in found:
        return "partly"
    return next(verdict for verdict in ("contradicted", "tied", "undecidable") if verdict in found)


class Vocabulary:
    """What a finding may name: the taxonomy's values and categories, and years."""

    def __init__(self, taxonomy: pd.DataFrame) -> None:
        self.values: dict[str, set[str]] = {}
        self.category: dict[tuple[str, str], str] = {}
        for row in taxonomy.itertuples(index=False):
            self.values.setdefault(str(row.attribute), set()).add(str(row.value))
            self.category[str(row.attribute), str(row.value)] = str(row.category)

    def categories(self, ranked: str) -> set[str]:
        """Return the categories of the attribute behind e.g. ``model_category``."""
        attribute = _CATEGORY_OF[ranked]
        return {name for (owner, _), name in self.category.items() if owner == attribute}

    def fault(self, ranked: str, value: str) -> str | None:
        """Say why a value cannot be expected of a ranked attribute; None where it can."""
        if ranked == _PAIR:
            detector, _, mask = value.partition("+")
            if detector in self.values.get("detector", ()) and mask in self.values.get("mask", ()):
                return None
            return f"unknown pair {value!r} of detector+mask"
        if ranked == "year":
            return None if re.fullmatch(r"[0-9]{4}", value) else f"{value!r} is no year"
        known = (
            self.categories(ranked) if ranked in _CATEGORY_OF else self.values.get(ranked, set())
        )
        return None if value in known else f"unknown value {value!r} of {ranked}"

    def rankable_attributes(self) -> set[str]:
        """Return everything `expects` may rank."""
        return {*self.values, *_CATEGORY_OF, _PAIR, "year"}


def parse_clause(row: Mapping[str, Any], vocabulary: Vocabulary) -> Clause:
    """Parse a row of the table of clauses.

    Raises
    ------
    FindingSyntaxError
        The row does not keep the grammar or names an unknown attribute, value or kind.
    """
    kind = str(row["kind"])
    if kind not in KINDS:
        raise FindingSyntaxError("kind", f"unknown kind {kind!r}; expected one of {KINDS}")
    given = tuple(_parse_given(row["given"], vocabulary))
    ranked, colon, listed = str(row["expects"]).partition(": ")
    if not colon or ranked not in vocabulary.rankable_attributes():
        raise FindingSyntaxError(
            "expects",
            f"expected 'attribute: values' with one of {sorted(vocabulary.rankable_attributes())}, "
            f"got {row['expects']!r}",
        )
    values = tuple(listed.split(">" if kind == "order" else "|"))
    for value in (one for named in values for one in named.split(_EITHER)):
        fault = vocabulary.fault(ranked, value)
        if fault is not None:
            raise FindingSyntaxError("expects", fault)
    if len(set(values)) != len(values) or (kind == "order" and len(values) < 2):
        raise FindingSyntaxError("expects", f"kind {kind} cannot rank the values {values}")
    if kind == "top-centroid" and ranked != "extractor":
        raise FindingSyntaxError("expects", f"kind top-centroid ranks the extractor, not {ranked}")
    return Clause(kind=kind, given=given, ranked=ranked, values=values)


def _parse_given(text: Any, vocabulary: Vocabulary) -> Iterable[tuple[str, tuple[str, ...]]]:
    if pd.isna(text):
        return
    for condition in str(text).split("&"):
        attribute, equals, named = condition.partition("=")
        if not equals or attribute not in vocabulary.values:
            raise FindingSyntaxError(
                "given",
                f"expected attribute=value with one of {sorted(vocabulary.values)}, "
                f"got {condition!r}",
            )
        values = tuple(named.split(_EITHER))
        for value in values:
            if value not in vocabulary.values[attribute]:
                raise FindingSyntaxError("given", f"unknown value {value!r} of {attribute}")
        yield attribute, values


def study_values(
    studies: pd.DataFrame,
    attributes: pd.DataFrame,
    architectures: pd.DataFrame,
    vocabulary: Vocabulary,
) -> dict[str, dict[str, frozenset[str]]]:
    """Return study -> attribute -> known values, with the derived attributes findings rank."""
    collected: dict[str, dict[str, set[str]]] = {
        str(key): {"year": {str(year)}}
        for key, year in zip(studies["key"], studies["year"], strict=True)
    }
    known = attributes[attributes["value"].notna()]
    for row in known.itertuples(index=False):
        collected[str(row.study)].setdefault(str(row.attribute), set()).add(str(row.value))
    sensors: dict[str, set[str]] = {}
    for row in architectures.itertuples(index=False):
        sensors.setdefault(str(row.study), set()).add(f"{row.detector}+{row.mask}")
    for key, values in collected.items():
        for derived, attribute in _CATEGORY_OF.items():
            values[derived] = {
                vocabulary.category[attribute, value] for value in values.get(attribute, ())
            }
        values[_PAIR] = sensors.get(key) or {
            f"{detector}+{mask}"
            for detector in values.get("detector", ())
            for mask in values.get("mask", ())
        }
    return {
        study: {attribute: frozenset(values) for attribute, values in entry.items() if values}
        for study, entry in collected.items()
    }


def evaluate(row: Mapping[str, Any], values: Values, vocabulary: Vocabulary) -> ClauseVerdict:
    """Judge a clause by the studies' values.

    Parameters
    ----------
    row : mapping
        A row of the table of clauses.
    values : mapping
        As `study_values` returns it.
    vocabulary : Vocabulary
        What the row may name.

    Raises
    ------
    FindingSyntaxError
        As `parse_clause`.
    """
    clause = parse_clause(row, vocabulary)
    matching = [entry for entry in values.values() if _passes(entry, clause.given)]
    counted = [entry[clause.ranked] for entry in matching if clause.ranked in entry]
    counts = _counts(clause, counted, vocabulary)
    tally = Tally(
        kind=clause.kind,
        ranked=clause.ranked,
        named={value: counts[value] for value in clause.values},
        others={value: n for value, n in counts.items() if value not in clause.values},
        counted=len(counted),
        matching=len(matching),
    )
    return ClauseVerdict(
        clause=int(row["clause"]),
        verdict=_judge(tally),
        statement=str(row["statement"]),
        given="" if pd.isna(row["given"]) else str(row["given"]),
        expects=str(row["expects"]),
        kind=clause.kind,
        matching=len(matching),
        counted=len(counted),
        ranking=tuple(sorted(counts.items(), key=lambda item: (-item[1], item[0]))),
        named=tuple(tally.named.items()),
        settled_by=settled_by(tally),
    )


def _passes(
    entry: Mapping[str, frozenset[str]], given: Iterable[tuple[str, tuple[str, ...]]]
) -> bool:
    return all(
        any(
            entry.get(attribute, frozenset()) & _INCLUDES.get((attribute, one), frozenset({one}))
            for one in values
        )
        for attribute, values in given
    )


def _counts(
    clause: Clause, counted: Iterable[frozenset[str]], vocabulary: Vocabulary
) -> Counter[str]:
    """Count the studies of each value; those that a clause names as one, as one."""
    name = {
        value: named for named in clause.values for value in named.split(_EITHER) if named != value
    }
    counts = Counter(named for entry in counted for named in {name.get(v, v) for v in entry})
    if clause.kind == "top-centroid":
        kept = [v for v in counts if vocabulary.category["extractor", v] == _CENTROID_FAMILY]
        return Counter({value: counts[value] for value in kept})
    return counts


def _judge(tally: Tally) -> Verdict:
    """Judge the counts that the clause hangs on."""
    if not tally.is_decided:
        return "undecidable"
    if tally.kind == NO_MAJORITY:
        return "reproduced" if 2 * tally.largest_count <= tally.counted else "contradicted"
    if tally.absent:
        return "contradicted"
    if tally.kind in OCCURRING or tally.closest is None:
        return "reproduced"
    (_, ours), (_, theirs) = tally.closest
    return "reproduced" if ours > theirs else "tied" if ours == theirs else "contradicted"
