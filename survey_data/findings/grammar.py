"""The findings' grammar, and how the tables answer them.

A finding has clauses, each of which is tested by itself. A clause filters the studies (`given`:
attribute=value joined by ``&``), ranks an attribute over them by the number of studies a value
occurs in, and says how named values rank (`expects`, `kind`). Values joined by `` or `` are
counted as one: a study with either counts once. A clause is

- ``reproduced`` where the known cells say so,
- ``undecidable`` where fewer than three studies that pass the filter have a known value of the
  ranked attribute, or where it does not hold by the known cells and could by the unknown ones,
- ``tied`` where an equal count alone stands in its way, and ``contradicted`` otherwise, whatever
  the unknown cells are. A named value that occurs in no study fails.

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

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import pandas as pd

from survey_data.findings.evidence import NO_MAJORITY

Entry = Mapping[str, frozenset[str]]
"""Known values of a study, by attribute."""

KINDS = (
    *("top", "top-set", "order", "bottom", "bottom-set", "among", "spread", "top-centroid"),
    NO_MAJORITY,
)
CENTROID_FAMILY = "Centroid detection"
CATEGORY_OF = {"model_category": "model", "extractor_family": "extractor"}
PAIR = "detector+mask"
_INCLUDES = {("detector", "PD"): frozenset({"PD", "QPD"})}
_EITHER = " or "


@dataclass(frozen=True)
class Clause:
    """One clause, parsed: filter conditions, ranked attribute and expected values."""

    kind: str
    given: tuple[tuple[str, tuple[str, ...]], ...]
    ranked: str
    values: tuple[str, ...]

    def as_named(self, values: Iterable[str]) -> frozenset[str]:
        """Return values under the clause's names: those that it counts as one under one."""
        name = {one: named for named in self.values for one in named.split(_EITHER)}
        return frozenset(name.get(value, value) for value in values)


class Vocabulary:
    """What a finding may name; of a `single` attribute a study has one value at most."""

    def __init__(self, taxonomy: pd.DataFrame, single: Collection[str] = ()) -> None:
        self.single = frozenset(single)
        self.values: dict[str, set[str]] = {}
        self.category: dict[tuple[str, str], str] = {}
        for row in taxonomy.itertuples(index=False):
            self.values.setdefault(str(row.attribute), set()).add(str(row.value))
            self.category[str(row.attribute), str(row.value)] = str(row.category)

    def categories(self, ranked: str) -> set[str]:
        """Return the categories of the attribute behind e.g. ``model_category``."""
        attribute = CATEGORY_OF[ranked]
        return {name for (owner, _), name in self.category.items() if owner == attribute}


def parse_clause(row: Mapping[str, Any]) -> Clause:
    """Parse a row of the table of clauses."""
    ranked, _, listed = str(row["expects"]).partition(": ")
    return Clause(
        kind=str(row["kind"]),
        given=tuple(_parse_given(row["given"])),
        ranked=ranked,
        values=tuple(listed.split(">" if row["kind"] == "order" else "|")),
    )


def _parse_given(text: Any) -> Iterable[tuple[str, tuple[str, ...]]]:
    if pd.isna(text):
        return
    for condition in str(text).split("&"):
        attribute, _, named = condition.partition("=")
        yield attribute, tuple(named.split(_EITHER))


def accepted(attribute: str, values: Iterable[str]) -> frozenset[str]:
    """Return the values of an attribute that a condition of a filter lets pass."""
    sets = (_INCLUDES.get((attribute, one), frozenset({one})) for one in values)
    return frozenset().union(*sets)


def passes(entry: Entry, given: Iterable[tuple[str, tuple[str, ...]]]) -> bool:
    """Say whether known values pass a filter."""
    return all(
        entry.get(attribute, frozenset()) & accepted(attribute, values)
        for attribute, values in given
    )
