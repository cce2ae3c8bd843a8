"""The known word that a wrong one was probably meant to be."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def nearest(word: str, known: Iterable[str], *, cutoff: float = 0.4) -> str | None:
    """Return the known word most like another, case aside; None where none is like it.

    Parameters
    ----------
    word
        What was given.
    known
        What could have been.
    cutoff
        Similarity (`difflib.SequenceMatcher.ratio`, 0 to 1) below which words are not alike.
    """
    folded = {each.casefold(): each for each in known}
    found = get_close_matches(word.casefold(), folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else None
