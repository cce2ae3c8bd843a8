"""Studies as BibTeX, RIS and CSL JSON, for programs that keep references.

Studies that nobody has identified - without a title - are left out: a reference without one finds
nothing. How sure an identification is stands with each.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

Study = Mapping[str, Any]
"""A row of studies.csv, or a study as the service answers with it."""


@dataclass(frozen=True)
class _Kind:
    """What a type of publication is called, and its venue: BibTeX, RIS, CSL."""

    bibtex: str
    bibtex_venue: str
    ris: str
    ris_venue: str
    csl: str
    csl_venue: str


_KINDS = MappingProxyType(
    {
        "journal": _Kind("article", "journal", "JOUR", "JO", "article-journal", "container-title"),
        "conference": _Kind(
            *("inproceedings", "booktitle", "CPAPER", "T2", "paper-conference", "container-title")
        ),
        "preprint": _Kind("misc", "howpublished", "UNPB", "T2", "article", "publisher"),
        "thesis": _Kind("phdthesis", "school", "THES", "PB", "thesis", "publisher"),
        "report": _Kind("techreport", "institution", "RPRT", "PB", "report", "publisher"),
    }
)
_OTHER = _Kind("misc", "howpublished", "GEN", "T2", "document", "container-title")

_ASIDE = re.compile(r"\s*\([^)]*\)")
_ARXIV = re.compile(r"10\.48550/arxiv\.(\S+)", re.IGNORECASE)
_SPECIAL = {
    **{character: f"\\{character}" for character in "&%$#_{}"},
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
_SURE = {
    "confirmed": "",
    "recalled": "identified from memory, not confirmed by a public page",
    "ambiguous": "several works fit the survey's key, this is the best candidate",
}


def list_identifiers(studies: Sequence[Study]) -> list[Study]:
    """Return the studies whose title is known."""
    return [study for study in studies if study["title"]]


def bibtex(studies: Sequence[Study]) -> str:
    """Write the identified studies as BibTeX, UTF-8, keys as the survey's."""
    return "\n".join(_bibtex(study) for study in list_identifiers(studies))


def ris(studies: Sequence[Study]) -> str:
    """Write the identified studies as RIS, UTF-8."""
    return "\n".join(_ris(study) for study in list_identifiers(studies))


def csl_json(studies: Sequence[Study]) -> str:
    """Write the identified studies as CSL JSON, a list of items."""
    items = [_csl(study) for study in list_identifiers(studies)]
    return json.dumps(items, indent=2, ensure_ascii=False) + "\n"


FORMS: Mapping[str, Callable[[Sequence[Study]], str]] = MappingProxyType(
    {"bibtex": bibtex, "ris": ris, "csl": csl_json}
)
"""Serialiser of each form of citation, by the name that a query and a command call it."""

SUFFIXES: Mapping[str, str] = MappingProxyType({"bibtex": "bib", "ris": "ris", "csl": "json"})
"""Suffix of a file of each form."""


def blank_bibtex(studies: Sequence[Study]) -> str:
    """Write studies as BibTeX to be filled in: what is confirmed stands there, the rest is blank.

    A title that nobody has confirmed stands above its entry as a comment: who sends the file back
    unchanged confirms nothing.
    """
    head = (
        "% Fill in the blanks and send this file, or the survey's own .bib.\n"
        "% An entry without a title says nothing, and may stay as it is.\n"
        "% Of @misc make @article, @inproceedings, @phdthesis or @techreport where it is one.\n"
    )
    return "\n".join([head, *map(_blank, studies)])


def _blank(study: Study) -> str:
    kind = _KINDS.get(study["type"], _OTHER)
    sure = study["identity"] == "confirmed"
    fields = {
        "title": "{" + _escape(study["title"]) + "}" if sure and study["title"] else "",
        "author": " and ".join(map(_person, names(study["authors"]))) if sure else "",
        "year": str(study["year"] or ""),
        kind.bibtex_venue: _escape(study["venue"]) if sure else "",
        "doi": _bare(study["doi"]) if sure else "",
    }
    perhaps = " ".join(study["title"].replace("@", "").split()) if not sure else ""
    said = f"% {study['key']} is perhaps: {perhaps}\n" if perhaps else ""
    lines = "".join(f"  {name} = {{{text}}},\n" for name, text in fields.items())
    return f"{said}@{kind.bibtex}{{{study['key']},\n{lines}}}\n"


def names(authors: str) -> list[tuple[str, str]]:
    """Split authors into (family, given) by BibTeX's rule; ("", "") means "and others".

    The family name is the last word and what precedes it in lower case. Remarks in parentheses are
    dropped.
    """
    found = []
    for author in _ASIDE.sub("", authors).split(";"):
        family, comma, given = author.partition(",")
        words = author.split()
        if not words:
            continue
        if words in (["et", "al."], ["others"]):
            found.append(("", ""))
            continue
        if comma:
            found.append((" ".join(family.split()), " ".join(given.split())))
            continue
        start = len(words) - 1
        lower = [n for n, word in enumerate(words[:start]) if word[0].islower()]
        start = lower[0] if lower else start
        found.append((" ".join(words[start:]), " ".join(words[:start])))
    return found


def _link(study: Study) -> str:
    """Return the address of a study, where it says more than its DOI."""
    url = str(study["url"])
    return "" if study["doi"] and url.endswith(study["doi"]) else url


def _sureness(study: Study) -> str:
    identity = str(study["identity"])
    return _SURE.get(identity, identity)


def _bibtex(study: Study) -> str:
    kind = _KINDS.get(study["type"], _OTHER)
    arxiv = _ARXIV.fullmatch(study["doi"])
    fields = {
        "title": "{" + _escape(study["title"]) + "}",
        "author": " and ".join(map(_person, names(study["authors"]))),
        "year": str(study["year"] or ""),
        kind.bibtex_venue: _escape(study["venue"]),
        "doi": _bare(study["doi"]),
        **({"eprint": _bare(arxiv[1]), "archiveprefix": "arXiv"} if arxiv else {}),
        "url": _bare(_link(study)),
        "note": _escape(_sureness(study)),
    }
    lines = "".join(f"  {name} = {{{text}}},\n" for name, text in fields.items() if text)
    return f"@{kind.bibtex}{{{study['key']},\n{lines}}}\n"


def _person(name: tuple[str, str]) -> str:
    """Return a name as BibTeX takes it: a word that it would read as a separator in braces."""
    if not any(name):
        return "others"
    text = _escape(", ".join(part for part in name if part))
    return "{" + text + "}" if " and " in f" {text} ".casefold() else text


def _escape(text: str) -> str:
    return "".join(_SPECIAL.get(character, character) for character in text)


def _bare(address: str) -> str:
    """Return an address as it is, but for braces, which would end the field."""
    return address.replace("{", "%7B").replace("}", "%7D").replace("\\", "%5C")


def _ris(study: Study) -> str:
    kind = _KINDS.get(study["type"], _OTHER)
    people = [", ".join(part for part in name if part) for name in names(study["authors"])]
    lines = [
        ("TY", kind.ris),
        ("ID", study["key"]),
        ("TI", study["title"]),
        *(("AU", person or "et al.") for person in people),
        ("PY", str(study["year"] or "")),
        (kind.ris_venue, study["venue"]),
        ("DO", study["doi"]),
        ("UR", _link(study)),
        ("N1", _sureness(study)),
    ]
    text = "".join(f"{tag}  - {' '.join(value.split())}\n" for tag, value in lines if value)
    return f"{text}ER  - \n"


def _csl(study: Study) -> dict[str, Any]:
    kind = _KINDS.get(study["type"], _OTHER)
    fields = {
        "id": study["key"],
        "type": kind.csl,
        "title": study["title"],
        "author": [_csl_name(*name) for name in names(study["authors"])],
        "issued": {"date-parts": [[int(study["year"])]]} if study["year"] else None,
        kind.csl_venue: study["venue"],
        "DOI": study["doi"],
        "URL": _link(study),
        "note": _sureness(study),
    }
    return {name: value for name, value in fields.items() if value}


def _csl_name(family: str, given: str) -> dict[str, str]:
    if not family:
        return {"literal": "et al."}
    return {"family": family, **({"given": given} if given else {})}
