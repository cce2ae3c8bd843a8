"""A finding: a sentence, the estimates in it with intervals, what is left out, and the pairs."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any, Self

from benchmark.metrics.intervals import median_interval, share_interval
from benchmark.metrics.separation import store

Pair = Mapping[str, Any]


@dataclass(frozen=True)
class Estimate:
    """A number with its 95 % interval.

    A ``median`` (interval by order statistics) or ``share`` (by Clopper and Pearson) of `n` units,
    `of` what they are; infinite where the data do not bound it.
    """

    name: str
    kind: str
    value: float
    low: float
    high: float
    n: int
    of: str

    @classmethod
    def median(cls, name: str, values: Sequence[float], of: str) -> Self:
        """Return the median of values with its interval."""
        return cls(name, "median", median(values), *median_interval(values), len(values), of)

    @classmethod
    def share(cls, name: str, count: int, n: int, of: str) -> Self:
        """Return a share with its interval."""
        return cls(name, "share", count / n, *share_interval(count, n), n, of)

    @property
    def interval(self) -> str:
        """The interval in words, of a share as percentages."""
        if self.kind == "share":
            return f"{100 * self.low:.0f} to {100 * self.high:.0f} %"
        return f"{number(self.low)} to {number(self.high)}"

    def row(self) -> dict[str, str | float | int | None]:
        """Return it as a row of a table; what is infinite is None."""
        values = {name: getattr(self, name) for name in ("value", "low", "high")}
        known = {name: store(value) for name, value in values.items()}
        return {"estimate": self.name, "kind": self.kind, **known, "n": self.n, "of": self.of}


@dataclass(frozen=True)
class Finding:
    """What the record shows.

    A sentence in bold, the text behind it with its estimates, the pairs excluded with their number
    and reason, and a row per pair that the estimates are of.
    """

    key: str
    title: str
    text: str
    estimates: tuple[Estimate, ...]
    left_out: tuple[str, ...]
    pairs: tuple[Pair, ...]

    @property
    def command(self) -> str:
        """The command that prints the pairs."""
        return f"sunatlas leaderboard findings {self.key}"

    @property
    def details(self) -> str:
        """What stands behind the title: the text, and what is left out."""
        return f"{self.text} Left out: {'; '.join(self.left_out) or 'nothing'}."

    @property
    def markdown(self) -> str:
        """All of it, with the command."""
        return f"**{self.title}** {self.details} Pairs: `{self.command}`"


def number(value: float) -> str:
    """Spell a number with two significant digits; whole where it is whole, and above ten."""
    if math.isinf(value):
        return "more than measured" if value > 0 else "unknown"
    if value == round(value) or abs(value) >= 9.95:
        return f"{value:.0f}"
    return f"{value:.{max(1 - math.floor(math.log10(abs(value))), 0)}f}"
