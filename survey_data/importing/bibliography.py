"""Reading a bibliography: BibTeX, or the .bbl that BibTeX makes of one, into entries by key."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from files.reading import FileRefusedError, read_bytes
from survey_data.problems import SurveyImportError

#: Fields that name where a work is published, first of these that is there.
_VENUES = (
    *("journal", "journaltitle", "booktitle", "series", "school", "institution"),
    *("howpublished", "publisher"),
)
_KINDS = {
    "article": "journal",
    "inproceedings": "conference",
    "conference": "conference",
    "incollection": "conference",
    "phdthesis": "thesis",
    "mastersthesis": "thesis",
    "thesis": "thesis",
    "techreport": "report",
    "report": "report",
}
_ACCENTS = {
    "`": "\u0300", "'": "\u0301", "^": "\u0302", "~": "\u0303", '"': "\u0308", "c": "\u0327",
    "v": "\u030c", "u": "\u0306", "H": "\u030b", "=": "\u0304", ".": "\u0307", "k": "\u0328",
    "r": "\u030a", "d": "\u0323", "b": "\u0331",
}  # fmt: skip
_LETTERS = {
    "ss": "ß", "o": "ø", "O": "Ø", "l": "ł", "L": "Ł", "ae": "æ", "AE": "Æ", "oe": "œ", "OE": "Œ",
    "aa": "å", "AA": "Å", "dh": "ð", "DH": "Ð", "dj": "đ", "DJ": "Đ", "th": "þ", "TH": "Þ",
    "i": "ı", "j": "ȷ",
}  # fmt: skip
_MOST_BYTES = 20_000_000


@dataclass(frozen=True)
class Entry:
    """What a bibliography says of a key; a text is empty where it says nothing.

    ``authors`` are separated by semicolons, ``kind`` is a type of the table of studies; ``line``
    is where the entry starts.
    """

    key: str
    title: str
    authors: str
    year: str
    venue: str
    kind: str
    doi: str
    line: int
    url: str = ""


def read_bibliography(path: str | Path) -> tuple[Entry, ...]:
    """Read the entries of a BibTeX or .bbl file, in its order.

    Raises
    ------
    SurveyImportError
        The file cannot be read, or holds no entry; it names what was expected.
    """
    where = Path(path)
    try:
        text = read_bytes(where, _MOST_BYTES).decode("utf-8-sig")
    except FileNotFoundError as error:
        raise SurveyImportError(f"cannot read {where}: {error.strerror}") from error
    except FileRefusedError as error:
        raise SurveyImportError(f"cannot read {where}: {error.reason}") from error
    except UnicodeDecodeError as error:
        raise SurveyImportError(f"{where.name} is not UTF-8 text") from error
    found = _items(text) if "\\bibitem" in text else _records(text)
    entries = tuple(found)
    if not entries:
        raise SurveyImportError(
            f"{where.name} holds no entry: expected BibTeX (@article{{...) or a .bbl (\\bibitem...)"
        )
    return entries


@dataclass(frozen=True)
class _Record:
    """An entry of BibTeX as it stands: its type, key, fields and line."""

    kind: str
    key: str
    fields: dict[str, str]
    line: int


def _records(text: str) -> Iterator[Entry]:
    """Give the entries of BibTeX, abbreviations and cross-references resolved."""
    strings: dict[str, str] = {}
    records: list[_Record] = []
    for start in re.finditer(r"@(\w+)\s*[{(]\s*", text):
        kind = start[1].casefold()
        if kind == "string":
            strings |= _fields(text, start.end(), strings)
        key = re.compile(r"([^\s,{}()=]+)\s*,").match(text, start.end())
        if kind not in {"comment", "string", "preamble"} and key is not None:
            line = text.count("\n", 0, start.start()) + 1
            records.append(_Record(kind, key[1], _fields(text, key.end(), strings), line))
    parents = {record.key.casefold(): record for record in reversed(records)}
    for record in records:
        fields = _inherited(record, parents)
        yield _entry(record.key, record.kind, fields, record.line)


def _inherited(record: _Record, parents: Mapping[str, _Record]) -> dict[str, str]:
    """Return an entry's fields with those that it takes from the one that it refers to."""
    parent = parents.get(record.fields.get("crossref", "").strip().casefold())
    if parent is None or parent is record:
        return record.fields
    taken = {name: value for name, value in parent.fields.items() if name != "title"}
    if parent.fields.get("title"):
        taken.setdefault("booktitle", parent.fields["title"])
    return taken | record.fields


def _fields(text: str, at: int, strings: Mapping[str, str]) -> dict[str, str]:
    """Return the fields of an entry, the first of each name, up to the brace that closes it."""
    fields: dict[str, str] = {}
    name = re.compile(r"\s*,?\s*([A-Za-z][\w:-]*)\s*=")
    while match := name.match(text, at):
        value, at = _value(text, match.end(), strings)
        fields.setdefault(match[1].casefold(), value)
    return fields


def _value(text: str, at: int, strings: Mapping[str, str]) -> tuple[str, int]:
    """Return a field's value, parts joined by # put together, and where it ends."""
    parts = []
    join = re.compile(r"\s*#")
    while True:
        while text[at : at + 1].isspace():
            at += 1
        if text[at : at + 1] == "{":
            end = _closing(text, at)
            part, at = text[at + 1 : end], end + 1
        elif text[at : at + 1] == '"':
            end = _closing_quote(text, at)
            part, at = text[at + 1 : end], end + 1
        else:
            word = re.compile(r"[^,})#\s]*").match(text, at)
            part = word[0] if word else ""
            at += len(part)
            part = strings.get(part.casefold(), part)
        parts.append(part)
        joined = join.match(text, at)
        if joined is None:
            return "".join(parts), at
        at = joined.end()


def _closing(text: str, at: int) -> int:
    """Return where the brace that opens at `at` is closed; the end of the text if nowhere."""
    depth = 0
    for place in range(at, len(text)):
        if text[place] in "{}" and text[place - 1 : place] != "\\":
            depth += 1 if text[place] == "{" else -1
            if depth == 0:
                return place
    return len(text)


def _closing_quote(text: str, at: int) -> int:
    depth = 0
    for place in range(at + 1, len(text)):
        if text[place] in "{}":
            depth += 1 if text[place] == "{" else -1
        elif text[place] == '"' and depth == 0 and text[place - 1] != "\\":
            return place
    return len(text)


def _items(text: str) -> Iterator[Entry]:
    """Give the entries of a .bbl whose style marks its fields by 'bibinfo'."""
    for start in re.finditer(r"\\bibitem\s*", text):
        at = start.end()
        if text[at : at + 1] == "[":
            at = _closing_label(text, at) + 1
        opened = text.find("{", at)
        key_end = _closing(text, opened) if opened >= 0 else -1
        if key_end < 0:
            continue
        end = text.find("\\bibitem", key_end)
        body = text[key_end + 1 : end if end >= 0 else len(text)]
        fields: dict[str, str] = {}
        for mark in re.finditer(r"\\(?:bibinfo\s*\{(\w+)\}|(doi|url)|href)\s*\{", body):
            value = body[mark.end() : _closing(body, mark.end() - 1)]
            name = mark[1] or mark[2] or "url"
            if name == "author" and "author" in fields:
                fields["author"] += f" and {value}"
            else:
                fields.setdefault(name, value)
        yield _entry(
            text[opened + 1 : key_end].strip(),
            "article" if "journal" in fields else "inproceedings" * ("booktitle" in fields),
            fields,
            text.count("\n", 0, start.start()) + 1,
        )


def _closing_label(text: str, at: int) -> int:
    """Return where the bracket of a label is closed, braces in it aside."""
    depth = 0
    for place in range(at, len(text)):
        if text[place] in "{}":
            depth += 1 if text[place] == "{" else -1
        elif text[place] == "]" and depth == 0:
            return place
    return len(text)


def _entry(key: str, kind: str, fields: Mapping[str, str], line: int) -> Entry:
    year = re.search(r"[0-9]{4}", fields.get("year", "") or fields.get("date", ""))
    doi = re.search(r"10\.[0-9]{4,9}/[^\s{}]+", _plain(fields.get("doi") or fields.get("url", "")))
    is_arxiv = "arxiv" in (fields.get("archiveprefix") or fields.get("eprinttype", "")).casefold()
    preprint = re.search(r"[0-9]{4}\.[0-9]{4,5}", fields.get("eprint", "")) if is_arxiv else None
    authors = [_natural(_plain(name)) for name in re.split(r"\s+and\s+", fields.get("author", ""))]
    return Entry(
        key=key,
        title=_plain(fields.get("title", "")).rstrip(".,"),
        authors="; ".join(name for name in authors if name),
        year=year[0] if year else "",
        venue=next((_plain(fields[name]) for name in _VENUES if fields.get(name)), ""),
        kind="preprint" if kind != "article" and preprint else _KINDS.get(kind, "unknown"),
        doi=doi[0].rstrip(".,;") if doi else f"10.48550/arXiv.{preprint[0]}" if preprint else "",
        line=line,
        url=_plain(fields.get("url", "")),
    )


def _natural(name: str) -> str:
    """Return "Last, First" as "First Last", and BibTeX's word for more authors as "et al."."""
    if name.strip() == "others":
        return "et al."
    last, comma, first = name.partition(",")
    return f"{first.strip()} {last.strip()}".strip() if comma else name.strip(" ,")


def _plain(text: str) -> str:
    """Return TeX as text: accents composed, commands and braces left out."""
    text = re.sub(r"(?<!\\)~", " ", text)
    text = re.sub(
        r"\\([`'^~\"=.]|[cvuHkrdb](?![A-Za-z]))\s*\{?\s*\\?([A-Za-z])\s*\}?",
        lambda m: unicodedata.normalize("NFC", m[2] + _ACCENTS[m[1]]),
        text,
    )
    letters = "|".join(sorted(_LETTERS, key=len, reverse=True))
    text = re.sub(rf"\\({letters})(?![A-Za-z])\s*", lambda m: _LETTERS[m[1]], text)
    text = re.sub(r"\\([&%$#_{}])", r"\1", re.sub(r"\\[,;: ]", " ", text))
    text = re.sub(r"\\[-/!]", "", text)
    text = re.sub(r"\\[A-Za-z]+\s*", "", text)
    text = re.sub(r"-{2,}", "-", text.replace("{", "").replace("}", ""))
    return " ".join(text.split())
