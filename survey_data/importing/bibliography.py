"""Reading publications from BibTeX and RIS."""

from __future__ import annotations

import logging
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import rispy
from bibtexparser.middlewares import RemoveEnclosingMiddleware
from bibtexparser.middlewares.names import (
    parse_single_name_into_parts,
    split_multiple_persons_names,
)
from bibtexparser.model import (
    Block,
    DuplicateBlockKeyBlock,
    DuplicateFieldKeyBlock,
    Field,
    ParsingFailedBlock,
    String,
)
from bibtexparser.model import Entry as BibtexEntry
from bibtexparser.splitter import Splitter
from pylatexenc.latex2text import LatexNodes2Text
from rispy.config import TAG_KEY_MAPPING

from survey_data.importing.writing import offered_text
from survey_data.problems import SurveyImportError

SUFFIXES = (".bib", ".ris")
_MOST_BYTES = 2_000_000  # thousands of entries; TeX takes half a minute for a million letters
_LONGEST_FIELD = 20_000
_MOST_ENTRIES = 10_000
#: What no text holds: what a terminal obeys, ends of lines and pages, lost letters, and what turns
#: the direction of reading, so that the rest is not what it looks like.
FORBIDDEN = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff\ufffd]"
)
#: Fields that name where a work is published, first of these that is there.
_VENUES = (
    *("journal", "journaltitle", "booktitle", "series", "school", "institution"),
    *("howpublished", "publisher"),
)
_TEXTS = (*_VENUES, "title", "year", "date", "volume", "number", "issue", "pages")
#: What BibTeX and RIS call each type of our table of studies.
_KINDS = {
    "journal": ("article", "JOUR", "JFULL", "EJOUR", "MGZN"),
    "conference": ("inproceedings", "conference", "incollection", "CONF", "CPAPER"),
    "thesis": ("phdthesis", "mastersthesis", "thesis", "THES"),
    "report": ("techreport", "report", "RPRT"),
    "preprint": ("preprint", "UNPB", "INPR"),
}
_KIND_OF = {name: kind for kind, names in _KINDS.items() for name in names}
_BRACED = r"\{((?:[^{}]++|\{(?:[^{}]++|\{[^{}]*+\})*+\})*+)\}"
_TEX = LatexNodes2Text(math_mode="text")
# Both warn of what they pass over; what matters of it is raised here.
for _library in ("bibtexparser", "pylatexenc"):
    logging.getLogger(_library).setLevel(logging.CRITICAL)


@dataclass(frozen=True)
class Entry:
    """What a bibliography says of a key; a text is empty where it says nothing.

    ``authors`` are separated by semicolons, ``venue`` ends with volume, number and pages, ``kind``
    is a type of the table of studies; ``line`` is where the entry starts, 1 in RIS.
    """

    key: str
    title: str
    authors: str
    year: str
    venue: str
    kind: str
    doi: str
    line: int = 1
    url: str = ""

    def columns(self) -> dict[str, str]:
        """Return it as columns of the table of studies."""
        names = ("key", "title", "authors", "year", "venue", "doi", "url")
        return {"type": self.kind} | {name: getattr(self, name) for name in names}


def read_bibliography(path: str | Path) -> tuple[Entry, ...]:
    """Read the entries of a bibliography in its order; BibTeX for any suffix but .ris.

    Raises
    ------
    SurveyImportError
        The file cannot be read, an entry is broken, or there is none.
    """
    where = Path(path)
    text = offered_text(where, _MOST_BYTES)
    read, expected = _bibtex, "BibTeX (@article{...)"
    if where.suffix.casefold() == ".ris":
        read, expected = _ris, "RIS (TY  - ...)"
    try:
        entries = tuple(islice(read(text, where.name), _MOST_ENTRIES + 1))
    except RecursionError as error:
        raise SurveyImportError(f"{where.name} is nested too deeply") from error
    if not entries:
        raise SurveyImportError(f"{where.name} holds no entry: expected {expected}")
    if len(entries) > _MOST_ENTRIES:
        raise SurveyImportError(f"{where.name} has more than {_MOST_ENTRIES} entries")
    for entry in entries:
        if found := FORBIDDEN.search("".join(entry.columns().values())):
            message = f"{entry.key!a} holds the character U+{ord(found[0]):04X}"
            raise SurveyImportError(f"{where.name}, line {entry.line}: {message}")
    return entries


def _bibtex(text: str, name: str) -> Iterator[Entry]:
    """Give the entries of BibTeX, abbreviations and cross-references resolved."""
    if len(re.findall(r"@\s*\w+\s*[{(]", text)) > _MOST_ENTRIES:
        raise SurveyImportError(f"{name} has more than {_MOST_ENTRIES} entries")
    blocks = [_sound(block, name) for block in Splitter(text).split().blocks]
    strings: dict[str, str] = {}
    records: list[tuple[BibtexEntry, dict[str, str]]] = []
    for block in blocks:
        if isinstance(block, String):
            said = _PLAIN.transform_string(block, None)  # type: ignore[arg-type]
            strings[block.key.casefold()] = _joined(said, strings, name)
    for block in blocks:
        if isinstance(block, BibtexEntry) and block.key:
            fields: dict[str, str] = {}
            for each in _PLAIN.transform_entry(block, None).fields:  # type: ignore[arg-type]
                fields.setdefault(each.key.casefold(), _joined(each, strings, name))
            records.append((block, fields))
    parents = {block.key.casefold(): fields for block, fields in reversed(records)}
    for block, fields in records:
        parent = parents.get(fields.get("crossref", "").strip().casefold(), {})
        taken = {"booktitle" if key == "title" else key: said for key, said in parent.items()}
        line = (block.start_line or 0) + 1
        yield _of_tex(block.key, block.entry_type, taken | fields, line)


_PLAIN = RemoveEnclosingMiddleware()


def _sound(block: Block, name: str) -> Block:
    """Return a block, or the one behind a warning of keys that stand twice; refuse a broken one."""
    if isinstance(block, DuplicateBlockKeyBlock | DuplicateFieldKeyBlock):
        return block.ignore_error_block or block
    if isinstance(block, ParsingFailedBlock):
        why = " ".join(str(getattr(block.error, "abort_reason", block.error)).split())
        line = (block.start_line or 0) + 1
        raise SurveyImportError(f"{name}, line {line}: a broken entry of BibTeX: {why}")
    return block


def _joined(said: Field | String, strings: Mapping[str, str], name: str) -> str:
    """Return a value with its abbreviations replaced and the parts that # joins put together."""
    text = str(said.value)
    if said.enclosing == "no-enclosing":
        parts = re.findall(rf'"([^"]*)"|{_BRACED}|([^\s#"{{}}]+)', text)
        text = ""
        for quoted, braced, word in parts:
            text += quoted or braced or strings.get(word.casefold(), word)
            if len(text) > _LONGEST_FIELD:
                break
    if len(text) > _LONGEST_FIELD:
        line = (said.start_line or 0) + 1
        message = f"{name}, line {line}: {said.key} is longer than {_LONGEST_FIELD} characters"
        raise SurveyImportError(message)
    return text


def _of_tex(key: str, kind: str, said: Mapping[str, str], line: int) -> Entry:
    authors = split_multiple_persons_names(said.get("author", ""))
    fields = {name: _plain(said[name]) for name in _TEXTS if name in said}
    links = {name: re.sub(r"[{}\\]|\burl\{", "", said.get(name, "")) for name in ("doi", "url")}
    is_arxiv = "arxiv" in (said.get("archiveprefix") or said.get("eprinttype", "")).casefold()
    preprint = re.search(r"[0-9]{4}\.[0-9]{4,5}", said.get("eprint", "")) if is_arxiv else None
    if preprint and kind != "article":
        kind = "preprint"
    arxiv = f"10.48550/arXiv.{preprint[0]}" if preprint else ""
    return _entry(
        key,
        kind,
        [_plain(_natural(name)) for name in authors],
        {
            **fields,
            "title": fields.get("title", "").rstrip(".,"),
            "year": fields.get("year") or fields.get("date", ""),
            "venue": next((fields[name] for name in _VENUES if fields.get(name)), ""),
            "number": fields.get("number") or fields.get("issue", ""),
            "doi": links["doi"] or links["url"],
            "arxiv": arxiv,
            "url": links["url"],
        },
        line,
    )


def _entry(
    key: str, kind: str, authors: Iterable[str], said: Mapping[str, str], line: int = 1
) -> Entry:
    """Return an entry of plain texts, spaces and missing fields made good."""
    texts = {name: " ".join(text.split()) for name, text in said.items()}
    year = re.search(r"[0-9]{4}", texts["year"])
    doi = re.search(r"10\.[0-9]{4,9}/\S+", texts["doi"])
    pages = texts.get("pages", "")
    venue = [
        texts["venue"],
        *(f"{mark} {texts[of]}" for mark, of in _NUMBERS if texts.get(of)),
        f"pp. {pages}" if "-" in pages else pages,
    ]
    return Entry(
        key=" ".join(key.split()),
        title=texts["title"],
        authors="; ".join(name for name in (" ".join(each.split()) for each in authors) if name),
        year=year[0] if year else "",
        venue=", ".join(filter(None, venue)) if texts["venue"] else "",
        kind=_KIND_OF.get(kind, "unknown"),
        doi=doi[0].rstrip(".,;") if doi else texts.get("arxiv", ""),
        line=line,
        url=texts["url"] if re.fullmatch(r"https?://\S+", texts["url"]) else "",
    )


_NUMBERS = (("vol.", "volume"), ("no.", "number"))


def _natural(name: str) -> str:
    """Return "Last, First" as "First Last", and BibTeX's word for more authors as "et al."."""
    if name == "others":
        return "et al."
    return parse_single_name_into_parts(name, strict=False).merge_first_name_first


def _plain(text: str) -> str:
    """Return TeX as text."""
    if re.search(r"[\\{}$~]|--|``|''", text):
        escaped = re.sub(r"(?<!\\)%", r"\\%", text)  # no comment starts inside a field
        text = _TEX.latex_to_text(escaped)
    return " ".join(re.sub("[\u2013\u2014]", "-", text).split())


def _ris(text: str, name: str) -> Iterator[Entry]:
    # rispy drops a record without its end, and takes a blank line for more of the field before.
    lines = [line for line in text.split("\n") if line.strip()]
    mapping = TAG_KEY_MAPPING | {"BT": "secondary_title"}
    try:
        records = rispy.loads("\n".join([*lines, "ER  - "]), mapping=mapping)
    except KeyError as error:
        raise SurveyImportError(f"{name}: a record of RIS starts without a tag") from error
    for record in records:
        if record.keys() - {"type_of_reference", "unknown_tag"}:
            yield _of_ris(record)


def _of_ris(record: Mapping[str, Any]) -> Entry:
    def first(*names: str) -> str:
        found = (record[name] for name in names if record.get(name))
        return next((str(each[0] if isinstance(each, list) else each) for each in found), "")

    names = record.get("authors") or record.get("first_authors") or ()
    pages = [first("start_page"), first("end_page")]
    return _entry(
        first("id"),
        first("type_of_reference"),
        map(_natural, names),
        {
            "title": first("title", "primary_title"),
            "year": first("year", "publication_year", "date"),
            "venue": first(
                *("secondary_title", "journal_name", "alternate_title3"),
                *("alternate_title2", "publisher"),
            ),
            "volume": first("volume"),
            "number": first("number"),
            "pages": "-".join(filter(None, pages)),
            "doi": first("doi"),
            "url": first("urls"),
        },
    )
