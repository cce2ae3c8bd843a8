"""Limits and what was measured: the one thing that every harness of `make bench` returns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Verdict:
    """A limit and what was measured.

    Attributes
    ----------
    what
        Which figure of which subject.
    value, most
        What was measured and the largest that is allowed.
    cannot
        Why the limit cannot be kept, where it was measured that it cannot; else empty.
    """

    what: str
    value: float
    most: float
    cannot: str = ""

    @property
    def holds(self) -> bool:
        """Whether the value is at most the limit; not where nothing was found."""
        return self.value <= self.most

    @property
    def breaks(self) -> bool:
        """Whether the limit is not kept and no reason excuses it."""
        return not self.holds and not self.cannot


def any_broken(found: Sequence[Verdict]) -> bool:
    """Whether a limit is not kept that no reason excuses."""
    return any(verdict.breaks for verdict in found)
