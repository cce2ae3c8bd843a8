"""What would settle a clause of a finding: the counts that decide it, and how far apart."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass, field

#: Fewer studies than this with a known value decide nothing.
LEAST_COUNTED = 3

FIRST_OF_SEVERAL = ("top", "top-centroid")
OCCURRING = ("among", "spread")
NO_MAJORITY = "no-majority"


@dataclass(frozen=True)
class Tally:
    """What a finding is judged by.

    `named` and `others` are the studies of the values that it names, in its order, and of all
    others that occur; `counted` have a known value of `ranked`, of the `matching` that pass the
    filter.
    """

    kind: str
    ranked: str
    named: Mapping[str, int] = field(hash=False)
    others: Mapping[str, int] = field(hash=False)
    counted: int
    matching: int

    @property
    def is_decided(self) -> bool:
        """Whether enough studies have a known value."""
        return self.counted >= LEAST_COUNTED

    @property
    def largest_count(self) -> int:
        """Studies of the most frequent value that is named."""
        return max(self.named.values(), default=0)

    @property
    def absent(self) -> list[str]:
        """Named values without which the finding fails, and which occur in no study."""
        missing = [value for value, count in self.named.items() if count == 0]
        if self.kind in FIRST_OF_SEVERAL and len(missing) < len(self.named):
            return []
        return missing

    @property
    def closest(self) -> tuple[tuple[str, int], tuple[str, int]] | None:
        """The two counts that it hangs on, of which the first must be the greater.

        None where nothing is counted beside what is named.
        """
        named = list(self.named.items())
        if self.kind.startswith("bottom"):
            rarest = min(self.others.items(), key=_rarest, default=None)
            return None if rarest is None else (rarest, max(named, key=lambda item: item[1]))
        rival = min(self.others.items(), key=_most, default=None)
        if self.kind in FIRST_OF_SEVERAL:
            return None if rival is None else (min(named, key=_most), rival)
        if self.kind == "top-set":
            return None if rival is None else (min(named, key=_rarest), rival)
        steps = itertools.pairwise([*named, *([] if rival is None else [rival])])
        return min(steps, key=lambda step: step[0][1] - step[1][1], default=None)


def settled_by(tally: Tally, turning: int | None = None) -> str:
    """Say which counts a verdict rests on, and which evidence would turn or decide it.

    `turning`: of how few studies the unknown cells could make a clause hold that does not by the
    known.
    """
    unknown = tally.matching - tally.counted
    if turning is not None:
        counts, _, _ = _margin(tally).partition(":")
        return f"{counts}; the unknown cells of {_studies(turning)} could make it hold"
    if not tally.is_decided:
        wanted = LEAST_COUNTED - tally.counted
        known = f"with a known {_in_words(tally.ranked)}"
        if unknown >= wanted:
            return f"{_studies(wanted)} of the {unknown} that match, {known}"
        return f"{_studies(wanted, 'more ')} that match{'es' if wanted == 1 else ''}, {known}"
    if not unknown:
        return _margin(tally)
    lacking = f"{unknown} of the {tally.matching} have no known {_in_words(tally.ranked)}"
    return f"{_margin(tally)}; {lacking}"


def _in_words(ranked: str) -> str:
    """Return what is ranked, an attribute or several, as a sentence has it."""
    return ranked.replace("+", " and ").replace("_", " ")


def _margin(tally: Tally) -> str:
    if tally.kind == NO_MAJORITY:
        value, count = min(tally.named.items(), key=_most)
        return f"{value} {count} of {tally.counted}, the most of those named"
    if tally.absent:
        return f"no study with {' or '.join(tally.absent)} is known"
    if tally.kind in OCCURRING:
        rarest, count = min(tally.named.items(), key=_rarest)
        return f"each occurs, {rarest} in {_studies(count)}"
    if tally.closest is None:
        return "nothing else occurs"
    (first, ours), (second, theirs) = tally.closest
    pair = f"{first} {ours} against {second} {theirs}"
    if ours > theirs:
        return f"{pair}: {_studies(ours - theirs, 'more ')} with {second} would tie them"
    return f"{pair}: {_studies(theirs - ours + 1, 'more ')} with {first} would turn it"


def _most(item: tuple[str, int]) -> tuple[int, str]:
    return -item[1], item[0]


def _rarest(item: tuple[str, int]) -> tuple[int, str]:
    return item[1], item[0]


def _studies(count: int, more: str = "") -> str:
    return f"{count} {more}{'study' if count == 1 else 'studies'}"
