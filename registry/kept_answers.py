"""What was made for one question and may serve the next, without ever keeping much."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import Generic, TypeVar

MOST_KEPT = 64

Made = TypeVar("Made")


class KeptAnswers(Generic[Made]):
    """The values last made, by key.

    Parameters
    ----------
    most : how many are kept; all are dropped when one more is made
    """

    def __init__(self, most: int | None = None) -> None:
        self.most = most
        self._kept: dict[Hashable, Made] = {}

    def get(self, key: Hashable, make: Callable[[], Made]) -> Made:
        """Return what is kept under a key, made now where nothing is."""
        found = self._kept.get(key)
        return self.keep(key, make()) if found is None else found

    def find(self, key: Hashable) -> Made | None:
        """Return what is kept under a key; None where nothing is."""
        return self._kept.get(key)

    def keep(self, key: Hashable, made: Made) -> Made:
        """Keep what was made, and return it."""
        if len(self._kept) >= (MOST_KEPT if self.most is None else self.most):
            self._kept.clear()
        self._kept[key] = made
        return made

    def __len__(self) -> int:
        return len(self._kept)
