"""The findings' grammar, and how the tables answer them.

A finding filters the studies (`given`: attribute=value joined by ``&``), ranks an attribute over
them by the number of studies a value occurs in, and says how named values rank (`expects`,
`kind`). Verdict: ``reproduced``, ``contradicted``, or ``undecidable`` where fewer than three
studies that pass the filter have a known value of the ranked attribute.

- ``top``: the most frequent value is one of those named (a tie for the first place counts).
- ``top-set``: of the n named, all but at most one are among the max(n, 2) most frequent, ties with
  the last of these included.
- ``order``: strictly falling in the order given, the first being the most frequent.
- ``bottom``, ``bottom-set``: no other occurring value is rarer than a named one.
- ``among``: every named value occurs. ``spread``: at least three of the named occur.
- ``top-centroid``: as ``top``, within the category Centroid detection.

``PD`` in a filter includes ``QPD``. Ranked besides attributes: ``detector+mask`` (pairs within a
study), ``model_category`` and ``extractor_family`` (the taxonomy's categories), ``year``.
"""

from __future__ import annotations

import itertools
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import pandas as pd

Verdict = Literal["reproduced", "contradicted", "undecidable"]
Values = Mapping[str, Mapping[str, frozenset[str]]]  # study -> attribute -> values

KINDS = ("top", "top-set", "order", "bottom", "bottom-set", "among", "spread", "top-centroid")
LEAST_COUNTED = 3
_CENTROID_FAMILY = "Centroid detection"
_INCLUDES = {("detector", "PD"): frozenset({"PD", "QPD"})}
_CATEGORY_OF = {"model_category": "model", "extractor_family": "extractor"}
_PAIR = "detector+mask"


class FindingSyntaxError(ValueError):
    """A finding does not keep the grammar; `column` names the cell."""

    def __init__(self, column: str, message: str) -> None:
        self.column = column
        super().__init__(message)


@dataclass(frozen=True)
class Finding:
    """One finding, parsed: filter conditions, ranked attribute and expected values."""

    id: str
    survey_section: str
    statement: str
    kind: str
    given: tuple[tuple[str, str], ...]
    ranked: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class FindingVerdict:
    """A finding's verdict and the counts behind it.

    `matching` studies pass the filter, `counted` of them have a known value of the ranked
    attribute; `ranking` is (value, number of studies), most frequent first, ties by name. `tied`:
    several values share the first place.
    """

    id: str
    verdict: Verdict
    kind: str
    survey_section: str
    given: str
    expects: str
    statement: str
    matching: int
    counted: int
    ranking: tuple[tuple[str, int], ...]
    tied: bool

    def to_dict(self) -> dict[str, Any]:
        """Return the verdict as plain JSON data."""
        return asdict(self) | {"ranking": [[value, count] for value, count in self.ranking]}


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

    def rankable(self) -> set[str]:
        """Return everything `expects` may rank."""
        return {*self.values, *_CATEGORY_OF, _PAIR, "year"}


def parse_finding(row: Mapping[str, Any], vocabulary: Vocabulary) -> Finding:
    """Parse a row of the findings table.

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
    if not colon or ranked not in vocabulary.rankable():
        raise FindingSyntaxError(
            "expects",
            f"expected 'attribute: values' with one of {sorted(vocabulary.rankable())}, "
            f"got {row['expects']!r}",
        )
    values = tuple(listed.split(">" if kind == "order" else "|"))
    for value in values:
        fault = vocabulary.fault(ranked, value)
        if fault is not None:
            raise FindingSyntaxError("expects", fault)
    if len(set(values)) != len(values) or (kind == "order" and len(values) < 2):
        raise FindingSyntaxError("expects", f"kind {kind} cannot rank the values {values}")
    if kind == "top-centroid" and ranked != "extractor":
        raise FindingSyntaxError("expects", f"kind top-centroid ranks the extractor, not {ranked}")
    return Finding(
        id=str(row["id"]),
        survey_section=str(row["survey_section"]),
        statement=str(row["statement"]),
        kind=kind,
        given=given,
        ranked=ranked,
        values=values,
    )


def _parse_given(text: Any, vocabulary: Vocabulary) -> Iterable[tuple[str, str]]:
    if pd.isna(text):
        return
    for condition in str(text).split("&"):
        attribute, equals, value = condition.partition("=")
        if not equals or attribute not in vocabulary.values:
            raise FindingSyntaxError(
                "given",
                f"expected attribute=value with one of {sorted(vocabulary.values)}, "
                f"got {condition!r}",
            )
        if value not in vocabulary.values[attribute]:
            raise FindingSyntaxError("given", f"unknown value {value!r} of {attribute}")
        yield attribute, value


def study_values(
    studies: pd.DataFrame, attributes: pd.DataFrame, vocabulary: Vocabulary
) -> dict[str, dict[str, frozenset[str]]]:
    """Return study -> attribute -> known values, with the derived attributes findings rank."""
    collected: dict[str, dict[str, set[str]]] = {
        str(key): {"year": {str(year)}}
        for key, year in zip(studies["key"], studies["year"], strict=True)
    }
    known = attributes[attributes["value"].notna()]
    for row in known.itertuples(index=False):
        collected[str(row.study)].setdefault(str(row.attribute), set()).add(str(row.value))
    for values in collected.values():
        for derived, attribute in _CATEGORY_OF.items():
            values[derived] = {
                vocabulary.category[attribute, value] for value in values.get(attribute, ())
            }
        values[_PAIR] = {
            f"{detector}+{mask}"
            for detector in values.get("detector", ())
            for mask in values.get("mask", ())
        }
    return {
        study: {attribute: frozenset(values) for attribute, values in entry.items() if values}
        for study, entry in collected.items()
    }


def evaluate(
    finding: Finding, row: Mapping[str, Any], values: Values, vocabulary: Vocabulary
) -> FindingVerdict:
    """Judge a finding by the studies' values.

    Parameters
    ----------
    finding : Finding
        The parsed finding.
    row : mapping
        The row it was parsed from, for the report.
    values : mapping
        As `study_values` returns it.
    vocabulary : Vocabulary
        For the family of ``top-centroid``.
    """
    matching = [entry for entry in values.values() if _passes(entry, finding.given)]
    counted = [entry[finding.ranked] for entry in matching if finding.ranked in entry]
    counts = Counter(value for entry in counted for value in entry)
    if finding.kind == "top-centroid":
        counts = Counter(
            {
                value: count
                for value, count in counts.items()
                if vocabulary.category["extractor", value] == _CENTROID_FAMILY
            }
        )
    ranking = tuple(sorted(counts.items(), key=lambda item: (-item[1], item[0])))
    verdict: Verdict = "undecidable"
    if len(counted) >= LEAST_COUNTED and ranking:
        verdict = "reproduced" if _holds(finding, counts, ranking) else "contradicted"
    return FindingVerdict(
        id=finding.id,
        verdict=verdict,
        kind=finding.kind,
        survey_section=finding.survey_section,
        given="" if pd.isna(row["given"]) else str(row["given"]),
        expects=str(row["expects"]),
        statement=finding.statement,
        matching=len(matching),
        counted=len(counted),
        ranking=ranking,
        tied=len(ranking) > 1 and ranking[0][1] == ranking[1][1],
    )


def _passes(entry: Mapping[str, frozenset[str]], given: Iterable[tuple[str, str]]) -> bool:
    return all(
        entry.get(attribute, frozenset()) & _INCLUDES.get((attribute, value), frozenset({value}))
        for attribute, value in given
    )


def _holds(finding: Finding, counts: Counter[str], ranking: tuple[tuple[str, int], ...]) -> bool:
    named = [counts[value] for value in finding.values]
    most = ranking[0][1]
    if finding.kind in {"top", "top-centroid"}:
        return most in named
    if finding.kind == "top-set":
        places = min(max(len(named), 2), len(ranking))
        least = ranking[places - 1][1]
        return sum(count < least for count in named) <= 1
    if finding.kind == "order":
        return named[0] == most and all(a > b for a, b in itertools.pairwise(named))
    if finding.kind in {"bottom", "bottom-set"}:
        others = [count for value, count in ranking if value not in finding.values]
        return not others or max(named) <= min(others)
    occurring = sum(count > 0 for count in named)
    return occurring >= 3 if finding.kind == "spread" else occurring == len(named)
