"""How the tables answer the findings: counts and verdicts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import pandas as pd

from survey_data import labels
from survey_data.findings.completions import fewest_to_hold, possibilities
from survey_data.findings.evidence import NO_MAJORITY, OCCURRING, Tally, settled_by
from survey_data.findings.grammar import (
    CATEGORY_OF,
    CENTROID_FAMILY,
    PAIR,
    Clause,
    Entry,
    Vocabulary,
    parse_clause,
    passes,
)
from survey_data.json_data import JsonData

Verdict = Literal["reproduced", "partly", "tied", "contradicted", "undecidable"]
VERDICTS: tuple[Verdict, ...] = ("reproduced", "partly", "tied", "contradicted", "undecidable")


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
class FindingVerdict(JsonData):
    """A finding's verdict, made of its clauses'; `not_tested` is what none of them tests."""

    id: str
    verdict: Verdict
    survey_section: str
    statement: str
    not_tested: str
    clauses: tuple[ClauseVerdict, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict as plain JSON data, with the name of its section."""
        return {**super().to_dict(), "section_name": labels.name(self.survey_section)}


def finding_verdict(clauses: Iterable[Verdict]) -> Verdict:
    """Return the verdict of a finding from those of its clauses."""
    found = set(clauses)
    if found == {"reproduced"}:
        return "reproduced"
    if "reproduced" in found:
        return "partly"
    return next(verdict for verdict in ("contradicted", "tied", "undecidable") if verdict in found)


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
        for derived, attribute in CATEGORY_OF.items():
            values[derived] = {
                vocabulary.category[attribute, value] for value in values.get(attribute, ())
            }
        values[PAIR] = sensors.get(key) or {
            f"{detector}+{mask}"
            for detector in values.get("detector", ())
            for mask in values.get("mask", ())
        }
    return {
        study: {attribute: frozenset(values) for attribute, values in entry.items() if values}
        for study, entry in collected.items()
    }


def evaluate(
    row: Mapping[str, Any], values: Mapping[str, Entry], vocabulary: Vocabulary
) -> ClauseVerdict:
    """Judge a row of the table of clauses by the studies' values."""
    clause = parse_clause(row)
    matching = [entry for entry in values.values() if passes(entry, clause.given)]
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
    verdict = _judge(tally)
    turning = None
    if verdict in {"tied", "contradicted"}:
        turning = fewest_to_hold(tally, possibilities(clause, values.values(), vocabulary))
        if turning is not None:
            verdict = "undecidable"
    return ClauseVerdict(
        clause=int(row["clause"]),
        verdict=verdict,
        statement=str(row["statement"]),
        given="" if pd.isna(row["given"]) else str(row["given"]),
        expects=str(row["expects"]),
        kind=clause.kind,
        matching=len(matching),
        counted=len(counted),
        ranking=tuple(sorted(counts.items(), key=lambda item: (-item[1], item[0]))),
        named=tuple(tally.named.items()),
        settled_by=settled_by(tally, turning),
    )


def _counts(
    clause: Clause, counted: Iterable[frozenset[str]], vocabulary: Vocabulary
) -> Counter[str]:
    """Count the studies of each value; those that a clause names as one, as one."""
    counts = Counter(value for entry in counted for value in clause.as_named(entry))
    if clause.kind == "top-centroid":
        kept = [v for v in counts if vocabulary.category["extractor", v] == CENTROID_FAMILY]
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
