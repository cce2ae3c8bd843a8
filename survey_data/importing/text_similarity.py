"""Comparing labels that people spell differently."""

from __future__ import annotations

import re
import unicodedata
from difflib import SequenceMatcher


def normalise(text: str) -> str:
    """Return a label in lower case, without accents, punctuation and plural endings."""
    decomposed = unicodedata.normalize("NFKD", text)
    plain = "".join(letter for letter in decomposed if not unicodedata.combining(letter))
    words = re.findall(r"[^\W_]+", plain.casefold())
    return " ".join(_singular(word) for word in words)


def _singular(word: str) -> str:
    plural = len(word) > 3 and word.endswith("s") and not word.endswith("ss")
    return word[:-1] if plural else word


def similarity(one: str, other: str) -> float:
    """Return how alike two normalised labels are, from 0 to 1."""
    if one == other:
        return 1.0
    return SequenceMatcher(None, one, other, autojunk=False).ratio()
