"""The publication of a study, read from BibTeX, RIS or CSL JSON."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from files.reading import FileRefusedError
from files.strict_json import read_json
from survey_data.additions.faults import Fault, FaultsError, one_of, read_text
from survey_data.importing.bibliography import read_bibliography

Publication = dict[str, str]
"""Columns of the table of studies."""

SUFFIXES = (".bib", ".bbl", ".ris", ".json")
_RIS_KINDS = {
    "JOUR": "journal",
    "JFULL": "journal",
    "EJOUR": "journal",
    "MGZN": "journal",
    "CONF": "conference",
    "CPAPER": "conference",
    "THES": "thesis",
    "RPRT": "report",
    "UNPB": "preprint",
    "INPR": "preprint",
}
_CSL_KINDS = {
    "article-journal": "journal",
    "paper-conference": "conference",
    "thesis": "thesis",
    "report": "report",
    "article": "preprint",
    "preprint": "preprint",
}
_RIS_LINE = re.compile(r"([A-Z][A-Z0-9])  - ?(.*)")
_KEY = re.compile(r"[A-Za-z]+[0-9]{4}[a-z]?")
_DOI = re.compile(r"10\.[0-9]{4,9}/\S+")


def read_publications(path: Path) -> tuple[Publication, ...]:
    """Read the publications of a file, each as columns of the table of studies.

    A key that is no key of ours is made of the first author's surname and the year.

    Raises
    ------
    FaultsError, SurveyImportError
        The file cannot be read, or holds no publication.
    """
    suffix = path.suffix.casefold()
    if suffix not in SUFFIXES:
        expected = ".toml, " + ", ".join(SUFFIXES)
        raise FaultsError(path.name, [Fault(None, f"expected a file that ends in {expected}")])
    if suffix == ".json":
        found = list(_csl(path))
    elif suffix == ".ris":
        found = list(_ris(path))
    else:
        found = list(_bibtex(path))
    if not found:
        raise FaultsError(path.name, [Fault(None, "holds no publication")])
    return tuple(_complete(each) for each in found)


def choose(publications: Sequence[Publication], key: str | None, file: str) -> Publication:
    """Return the publication of a key, or the only one; FaultsError where that is not clear."""
    keys = [each["key"] for each in publications]
    if len(publications) == 1 and not key:
        return publications[0]
    if key in keys:
        return publications[keys.index(key)]
    if len(publications) == 1:
        return {**publications[0], "key": str(key)}
    message = f"holds {len(keys)} publications: choose one with --key ({', '.join(keys[:12])})"
    if key:
        message = f"key {key!r}: {one_of(key, keys)}"
    raise FaultsError(file, [Fault(None, message)])


def _bibtex(path: Path) -> Iterator[Publication]:
    for entry in read_bibliography(path):
        yield {
            "key": entry.key,
            "title": entry.title,
            "authors": entry.authors,
            "year": entry.year,
            "venue": entry.venue,
            "type": entry.kind,
            "doi": entry.doi,
            "url": entry.url,
        }


def _ris(path: Path) -> Iterator[Publication]:
    text = read_text(path)
    tags: dict[str, list[str]] = {}
    for line in text.splitlines():
        match = _RIS_LINE.match(line.strip("\ufeff"))
        if match is None:
            continue
        tag, value = match[1], match[2].strip()
        if tag == "ER":
            if tags:
                yield _of_ris(tags)
            tags = {}
        elif value:
            tags.setdefault(tag, []).append(value)
    if tags:
        yield _of_ris(tags)


def _of_ris(tags: Mapping[str, Sequence[str]]) -> Publication:
    def first(*names: str) -> str:
        return next((tags[name][0] for name in names if name in tags), "")

    return {
        "key": first("ID"),
        "title": first("TI", "T1"),
        "authors": "; ".join(_natural(name) for name in tags.get("AU", tags.get("A1", ()))),
        "year": first("PY", "Y1", "DA"),
        "venue": first("T2", "JO", "JF", "JA", "BT", "PB"),
        "type": _RIS_KINDS.get(first("TY"), "unknown"),
        "doi": first("DO"),
        "url": first("UR"),
    }


def _csl(path: Path) -> Iterator[Publication]:
    try:
        document = read_json(path)
    except FileNotFoundError as error:
        raise FaultsError(path.name, [Fault(None, "there is no such file")]) from error
    except FileRefusedError as error:
        raise FaultsError(path.name, [Fault(error.line, error.reason)]) from error
    items = document if isinstance(document, list) else [document]
    for at, item in enumerate(items):
        if not isinstance(item, dict):
            message = f"item {at + 1}: expected an object of CSL JSON, got {type(item).__name__}"
            raise FaultsError(path.name, [Fault(None, message)])
        yield {
            "key": _scalar(item.get("id")),
            "title": _scalar(item.get("title")),
            "authors": "; ".join(_csl_names(item.get("author"))),
            "year": _csl_year(item.get("issued")),
            "venue": _scalar(item.get("container-title")) or _scalar(item.get("publisher")),
            "type": _CSL_KINDS.get(_scalar(item.get("type")), "unknown"),
            "doi": _scalar(item.get("DOI")),
            "url": _scalar(item.get("URL")),
        }


def _csl_names(given: Any) -> Iterator[str]:
    for name in given if isinstance(given, list) else ():
        if isinstance(name, dict):
            parts = (name.get("given"), name.get("non-dropping-particle"), name.get("family"))
            said = " ".join(filter(None, map(_scalar, parts))) or _scalar(name.get("literal"))
            if said:
                yield said.replace(";", ",")


def _csl_year(issued: Any) -> str:
    if not isinstance(issued, dict):
        return ""
    parts = issued.get("date-parts")
    if isinstance(parts, list) and parts and isinstance(parts[0], list) and parts[0]:
        return _scalar(parts[0][0])
    return _scalar(issued.get("raw")) or _scalar(issued.get("literal"))


def _scalar(value: Any) -> str:
    """Return a text or a number as text; the first of a list; '' for anything else."""
    if isinstance(value, list):
        return _scalar(value[0]) if value else ""
    return str(value) if isinstance(value, str | int) and not isinstance(value, bool) else ""


def _natural(name: str) -> str:
    """Return "Last, First" as "First Last"."""
    last, comma, first = name.partition(",")
    return f"{first.strip(' ,')} {last.strip()}".strip() if comma else name.strip()


def _complete(found: Publication) -> Publication:
    """Return a publication with a plain year and DOI, and with a key of ours."""
    found = {name: " ".join(value.split()) for name, value in found.items()}
    year = re.search(r"[0-9]{4}", found["year"])
    doi = _DOI.search(found["doi"])
    found |= {"year": year[0] if year else "", "doi": doi[0].rstrip(".,;") if doi else ""}
    if not re.fullmatch(r"https?://\S+", found["url"]):
        found["url"] = ""
    if not _KEY.fullmatch(found["key"]):
        first = found["authors"].split(";")[0].split()
        letters = unicodedata.normalize("NFKD", first[-1]) if first else ""
        surname = re.sub(r"[^A-Za-z]", "", letters)
        found["key"] = f"{surname}{found['year']}" if surname and found["year"] else ""
    return found
