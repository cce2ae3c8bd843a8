"""Ranked search in a few hundred short texts: forgiving of endings and slips of the keyboard.

Ranking is BM25F (Robertson & Zaragoza 2009, "The Probabilistic Relevance Framework"): a word counts
more the rarer it is, and in a name or title more than in a text. A word asked for also finds words
that begin with it, and words a slip or two away, at a discount. Same index and question, same
answer: ties are broken by kind and name.
"""

from __future__ import annotations

import math
import re
import unicodedata
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

_K1 = 1.2  # how fast repetition stops counting
_B = 0.6  # how much a long text is held against its words
_WEIGHTS = {"name": 8.0, "title": 4.0, "words": 2.0, "text": 1.0}
_BEGINS = 0.6  # what a word counts that only begins with the one asked for
_SLIPPED = {1: 0.4, 2: 0.2}  # what a word counts that is one or two slips away
_SHORTEST_BEGINNING = 3
EXCERPT = 160  # characters, about

_RUN = re.compile(r"[^\W_]+")
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

    @property
    def fields(self) -> Mapping[str, str]:
        """The searched texts by the weight they have."""
        return {"name": self.id, "title": self.title, "words": self.words, "text": self.text}


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
    _found: dict[str, Mapping[int, float]] = field(default_factory=dict, init=False, repr=False)

    def find(self, question: str, kinds: Collection[str] = ()) -> list[Hit]:
        """Return what answers a question, the best first.

        What is called just so comes first; then what has every word of the question before what
        lacks one, and so on.

        Parameters
        ----------
        question : words; punctuation, case and accents do not matter
        kinds : only these; all where empty
        """
        words = list(dict.fromkeys(tokens(question)))
        expanded = [self._meant(word) for word in words]
        found: dict[int, list[float]] = {}
        for meant in expanded:
            best: dict[int, float] = {}
            for word, discount in meant.items():
                for number, score in self._scores(word).items():
                    best[number] = max(best.get(number, 0.0), discount * score)
            for number, score in best.items():
                found.setdefault(number, []).append(score)
        called = self._called.get(tuple(words), set())
        ranked = sorted(
            found.items(),
            key=lambda item: (item[0] not in called, -len(item[1]), -sum(item[1]), item[0]),
        )
        every = {word for meant in expanded for word in meant}
        return [
            Hit(self.entries[number], round(sum(scores), 4), excerpt(self.entries[number], every))
            for number, scores in ranked
            if not kinds or self.entries[number].kind in kinds
        ]

    @cached_property
    def _called(self) -> Mapping[tuple[str, ...], set[int]]:
        """Entries by the words of their name, and of their title."""
        found: dict[tuple[str, ...], set[int]] = {}
        for number, entry in enumerate(self.entries):
            for name in (entry.id, entry.title):
                found.setdefault(tuple(dict.fromkeys(tokens(name))), set()).add(number)
        return found

    @cached_property
    def _counts(self) -> list[dict[str, float]]:
        """Weighted count of each word of each entry."""
        counts = []
        for entry in self.entries:
            words: dict[str, float] = {}
            for name, text in entry.fields.items():
                for word in tokens(text):
                    words[word] = words.get(word, 0.0) + _WEIGHTS[name]
            counts.append(words)
        return counts

    @cached_property
    def _lengths(self) -> list[float]:
        """Length of each entry over the mean."""
        totals = [sum(words.values()) for words in self._counts]
        mean = sum(totals) / max(len(totals), 1) or 1.0
        return [total / mean for total in totals]

    @cached_property
    def _vocabulary(self) -> dict[str, list[int]]:
        """Entries by word."""
        found: dict[str, list[int]] = {}
        for number, words in enumerate(self._counts):
            for word in words:
                found.setdefault(word, []).append(number)
        return dict(sorted(found.items()))

    @cached_property
    def _letters(self) -> list[tuple[str, int]]:
        """Words with the set of their characters as bits: what cannot be near is soon passed."""
        return [(word, _bits(word)) for word in self._vocabulary]

    def _scores(self, word: str) -> Mapping[int, float]:
        """Return what each entry scores for a word of the vocabulary."""
        if word not in self._found:
            holders = self._vocabulary[word]
            rarity = math.log1p((len(self.entries) - len(holders) + 0.5) / (len(holders) + 0.5))
            self._found[word] = {
                n: rarity * count * (_K1 + 1) / (count + _K1 * (1 - _B + _B * self._lengths[n]))
                for n in holders
                for count in (self._counts[n][word],)
            }
        return self._found[word]

    def _meant(self, word: str) -> dict[str, float]:
        """Return words of the vocabulary that a word of the question can mean, with discounts.

        Slips are allowed for only where nothing is spelt so or begins so.
        """
        meant = {word: 1.0} if word in self._vocabulary else {}
        if len(word) >= _SHORTEST_BEGINNING:
            for other in self._vocabulary:
                if other != word and other.startswith(word):
                    meant[other] = _BEGINS
        if meant or word.isdigit():
            return meant
        slips = 0 if len(word) < 4 else 1 if len(word) < 8 else 2
        bits = _bits(word)
        for other, others in self._letters:
            if abs(len(other) - len(word)) > slips or (bits ^ others).bit_count() > 2 * slips:
                continue
            distance = slips_between(word, other)
            if 0 < distance <= slips:
                meant[other] = _SLIPPED[distance]
        return meant


def tokens(text: str) -> Iterator[str]:
    """Yield the words of a text without case and accents; of `Liebe2001` its parts, too."""
    plain = unicodedata.normalize("NFKD", text).casefold()
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    for run in _RUN.findall(plain):
        yield run
        parts = _PARTS.findall(run)
        if len(parts) > 1:
            yield from parts


def slips_between(one: str, other: str) -> int:
    """Return how many letters have to be added, left out, changed or swapped with the next.

    The optimal string alignment distance (Damerau 1964, no letter touched twice).
    """
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, start=1):
        last, before, row = before, row, [i]
        for j, target in enumerate(other, start=1):
            cost = letter != target
            best = min(row[j - 1] + 1, before[j] + 1, before[j - 1] + cost)
            if i > 1 and j > 1 and letter == other[j - 2] and one[i - 2] == target:
                best = min(best, last[j - 2] + 1)
            row.append(best)
    return row[-1]


def excerpt(entry: Entry, words: Collection[str]) -> str:
    """Return a part of an entry's text about the first of the words, cut between words."""
    text = entry.text or entry.words
    if len(text) <= EXCERPT:
        return text
    at = next(
        (
            run.start()
            for run in _RUN.finditer(text)
            if not set(tokens(run.group())).isdisjoint(words)
        ),
        0,
    )
    start = max(0, min(at - EXCERPT // 3, len(text) - EXCERPT))
    if start:
        start = text.find(" ", start) + 1
    end = start + EXCERPT
    if end < len(text):
        end = max(text.rfind(" ", start, end), start + 1)
    return f"{'… ' if start else ''}{text[start:end].strip()}{' …' if end < len(text) else ''}"


def _bits(word: str) -> int:
    bits = 0
    for letter in word:
        bits |= 1 << (ord(letter) % 61)
    return bits
