"""The nearest valid word to a wrong one, for refusals that help."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

LONGEST_COMPARED = 64  # similarity is quadratic in length; no valid word is longer


def nearest(text: str, valid: Iterable[str]) -> str | None:
    """Return the valid word most similar to `text`, case aside; None where nothing is alike.

    Ties go to the word that comes first in alphabetical order, so that the answer does not
    depend on the order the words are given in.
    """
    wanted = text.strip().casefold()[:LONGEST_COMPARED]
    best: str | None = None
    best_ratio = 0.0
    matcher = SequenceMatcher(autojunk=False)
    matcher.set_seq2(wanted)
    for word in sorted(valid):
        matcher.set_seq1(word.casefold()[:LONGEST_COMPARED])
        ratio = matcher.ratio()
        if ratio > best_ratio:
            best, best_ratio = word, ratio
    return best
