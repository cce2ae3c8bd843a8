"""The known word that a wrong one was probably meant to be, and how an error names it."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import SequenceMatcher

_MOST_LISTED = 12
_LONGEST_COMPARED = 64  # similarity is quadratic in length; no known word is longer


def nearest_name(word: str, known: Iterable[str], *, cutoff: float = 0.4) -> str | None:
    """Return the known word most like another, case aside; None where none is like it.

    Words without a letter in common, or whose similarity (`difflib.SequenceMatcher.ratio`, 0 to 1)
    is below the cutoff, are not alike. Of words that are equally alike, the first in alphabetical
    order is taken, so that the answer does not depend on the order they are given in.
    """
    matcher = SequenceMatcher(autojunk=False)
    matcher.set_seq2(word.strip().casefold()[:_LONGEST_COMPARED])
    best: str | None = None
    best_ratio = 0.0
    for each in sorted(known):
        matcher.set_seq1(each.casefold()[:_LONGEST_COMPARED])
        # Each is an upper limit of the next, and costs less.
        if matcher.real_quick_ratio() > best_ratio and matcher.quick_ratio() > best_ratio:
            ratio = matcher.ratio()
            if ratio > best_ratio and ratio >= cutoff:
                best, best_ratio = each, ratio
    return best


def one_of(value: object, words: Iterable[str], near: Iterable[tuple[str, str]] = ()) -> str:
    """Say of which words a value should have been, and which of them is most like it.

    `near` are further spellings, each with its word.
    """
    allowed, spelt = list(words), dict(near)
    meant = nearest_name(str(value), [*allowed, *spelt], cutoff=0.5)
    hint = f", did you mean {spelt.get(meant, meant)}?" if meant else ""
    listed = ", ".join(allowed[:_MOST_LISTED]) + (", ..." if len(allowed) > _MOST_LISTED else "")
    return f"expected one of {listed}{hint}"
