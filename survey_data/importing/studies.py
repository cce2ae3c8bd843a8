"""Which study a row of another table is about: by key, by title, or by author and year."""

from __future__ import annotations

import re
from functools import partial

from survey_data.importing.values import normalise
from survey_data.tables import SurveyTables

_KEY = re.compile(r"([^\W\d_]+)([0-9]{4})([a-z]?)")


class StudyNotFoundError(LookupError):
    """A row names no study of ours, or could mean several."""


class StudyFinder:
    """Finds studies by what a row says of them."""

    def __init__(self, tables: SurveyTables) -> None:
        self._by_key = {str(key).casefold(): str(key) for key in tables.studies["key"]}
        mapped = tables.references.dropna(subset=["mapped_key"])
        for key, meant in zip(mapped["key"], mapped["mapped_key"], strict=True):
            self._by_key.setdefault(str(key).casefold(), str(meant))
        titled = tables.studies.dropna(subset=["title"])
        self._titles: dict[str, list[str]] = {}
        for key, title in zip(titled["key"], titled["title"], strict=True):
            self._titles.setdefault(normalise(str(title)), []).append(str(key))
        # (surname as in the key, year) -> keys
        self._by_author: dict[tuple[str, str], list[str]] = {}
        for key in map(str, tables.studies["key"]):
            parts = _KEY.fullmatch(key)
            if parts is not None:
                entry = (_letters(parts[1]), parts[2])
                self._by_author.setdefault(entry, []).append(key)

    def find(self, study: str = "", title: str = "", authors: str = "", year: str = "") -> str:
        """Return the key of the study that a row is about by its key, title, or authors and year.

        The first that decides is taken; StudyNotFoundError says why none does.
        """
        found = self._by_key.get(study.strip().casefold())
        if found is not None:
            return found
        reasons = [f"no study has the key {study!r}"] if study else []
        for said, look in (
            (title, partial(self._find_title, title)),
            (authors and year, partial(self._find_author, authors, year)),
        ):
            try:
                if said:
                    return look()
            except StudyNotFoundError as error:
                reasons.append(str(error))
        raise StudyNotFoundError("; ".join(reasons) or "the row names no study")

    def _find_title(self, title: str) -> str:
        keys = self._titles.get(normalise(title))
        if not keys:
            raise StudyNotFoundError(f"no study has the title {title!r}")
        if len(keys) > 1:
            raise StudyNotFoundError(f"the title {title!r} may mean {' or '.join(sorted(keys))}")
        return keys[0]

    def _find_author(self, authors: str, year: str) -> str:
        first = re.split(r"[;,&]|\band\b|\bet\b", authors)[0]
        words = first.split()
        for start in range(len(words)):
            surname = _letters("".join(words[start:]))
            keys = self._by_author.get((surname, year), [])
            if len(keys) == 1:
                return keys[0]
            if keys:
                raise StudyNotFoundError(f"{authors!r}, {year} may mean {' or '.join(keys)}")
        raise StudyNotFoundError(f"no study by {authors!r} of {year}")


def _letters(text: str) -> str:
    return normalise(text).replace(" ", "")
