"""Ranked search in a few hundred short texts, by SQLite's full-text search (FTS5, BM25).

A word counts more the rarer it is, and in a name or title more than in a text. A word asked for
also finds words that begin with it; where there is none, words most like it. Same index and
question, same answer: ties are broken by kind and name.
"""

from __future__ import annotations

import re
import sqlite3
import unicodedata
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property
from weakref import finalize

_WEIGHTS = "8.0, 4.0, 2.0, 1.0, 4.0"  # of the columns
_LIKE = 0.75  # similarity of a word that was probably meant (`difflib`)
_SHORTEST_BEGINNING, _SHORTEST_SLIP = 3, 4  # letters
_TABLE = (
    "CREATE VIRTUAL TABLE entry USING "
    "fts5(name, title, words, text, parts, tokenize='unicode61 remove_diacritics 2')"
)
_FIND = (
    f"SELECT rowid, -bm25(entry, {_WEIGHTS}), snippet(entry, 3, '', '', '…', 24) "  # noqa: S608 - ours
    "FROM entry WHERE entry MATCH ?"
)
_PARTS = re.compile(r"\d+|[^\W\d_]+")


@dataclass(frozen=True)
class Entry:
    """A thing that can be found.

    Attributes
    ----------
    kind : study, algorithm, dataset, claim, attribute, word
    id : its name among its kind
    title : what a list of results shows
    words : short words that describe it
    text : sentences
    address : where the service tells it; None where it has no address of its own
    """

    kind: str
    id: str
    title: str
    words: str = ""
    text: str = ""
    address: str | None = None


@dataclass(frozen=True)
class Hit:
    """A thing found, its score (higher is better), and where in its text."""

    entry: Entry
    score: float
    excerpt: str


@dataclass(frozen=True)
class Index:
    """Entries that can be searched.

    Parameters
    ----------
    entries : in the order that breaks ties
    """

    entries: Sequence[Entry]

    def find(self, question: str, kinds: Collection[str] = ()) -> list[Hit]:
        """Return what answers a question, the best first.

        What is called just so comes first; then what has every word of the question before what
        lacks one, and so on.

        Parameters
        ----------
        question : words; punctuation, case and accents do not matter
        kinds : only these; all where empty
        """
        words = tokens(question)
        found: dict[int, list[float]] = {}
        excerpts: dict[int, str] = {}
        for word in words:
            for number, score, excerpt in self._table.execute(_FIND, (self._meant(word),)):
                found.setdefault(number, []).append(score)
                excerpts.setdefault(number, excerpt)
        called = {
            number
            for number in found
            for name in (self.entries[number].id, self.entries[number].title)
            if tokens(name) == words
        }
        ranked = sorted(
            found.items(),
            key=lambda item: (item[0] not in called, -len(item[1]), -sum(item[1]), item[0]),
        )
        return [
            Hit(entry, round(sum(scores), 4), excerpts[number] or entry.words)
            for number, scores in ranked
            if (entry := self.entries[number]).kind in kinds or not kinds
        ]

    @cached_property
    def _table(self) -> sqlite3.Connection:
        table = sqlite3.connect(":memory:", check_same_thread=False)
        finalize(self, table.close)  # which Python 3.13 would have closed before it goes
        table.execute(_TABLE)
        table.executemany(
            "INSERT INTO entry (rowid, name, title, words, text, parts) VALUES (?, ?, ?, ?, ?, ?)",
            (
                (number, one.id, one.title, one.words, one.text, " ".join(_PARTS.findall(one.id)))
                for number, one in enumerate(self.entries)
            ),
        )
        return table

    @cached_property
    def _vocabulary(self) -> list[str]:
        self._table.execute("CREATE VIRTUAL TABLE term USING fts5vocab(entry, row)")
        return [term for (term,) in self._table.execute("SELECT term FROM term")]

    def _meant(self, word: str) -> str:
        """Return the words that a word of the question can mean, as FTS5 takes them."""
        known = [one for one in self._vocabulary if one.startswith(word)]
        if word in known and len(word) < _SHORTEST_BEGINNING:
            known = [word]
        elif not known and len(word) >= _SHORTEST_SLIP and not word.isdigit():
            known = get_close_matches(word, self._vocabulary, cutoff=_LIKE)
        return " OR ".join(f'"{one}"' for one in known) or '""'


def tokens(text: str) -> list[str]:
    """Return the words of a text, each once, without case and accents."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    return list(dict.fromkeys(re.findall(r"[^\W_]+", plain)))
