"""The studies as BibTeX and as RIS, for programs that keep references.

Studies that nobody has identified - without a title - are left out: a reference without one finds
nothing. How sure an identification is stands with each.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

FOLDER = "bibliography"

Study = Mapping[str, str]

_ASIDE = re.compile(r"\s*\([^)]*\)")
_SPECIAL = {
    **{character: f"\\{character}" for character in "&%$#_{}"},
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
}
_BIBTEX = {
    "journal": ("article", "journal"),
    "conference": ("inproceedings", "booktitle"),
    "thesis": ("phdthesis", "school"),
    "report": ("techreport", "institution"),
}
_RIS = {
    "journal": ("JOUR", "JO"),
    "conference": ("CPAPER", "T2"),
    "thesis": ("THES", "PB"),
    "report": ("RPRT", "PB"),
    "preprint": ("UNPB", "T2"),
}
_SURE = {
    "confirmed": "",
    "recalled": "identified from memory, not confirmed by a public page",
    "ambiguous": "several works fit the survey's key, this is the best candidate",
}


def identified(studies: Sequence[Study]) -> list[Study]:
    """Return the studies whose title is known."""
    return [study for study in studies if study["title"]]


def bibtex(studies: Sequence[Study]) -> str:
    """Write the identified studies as BibTeX, UTF-8, keys as the survey's."""
    return "\n".join(_bibtex(study) for study in identified(studies))


def ris(studies: Sequence[Study]) -> str:
    """Write the identified studies as RIS, UTF-8."""
    return "\n".join(_ris(study) for study in identified(studies))


def names(authors: str) -> list[tuple[str, str]]:
    """Split authors into (family, given), by BibTeX's own rule; ("", "") stands for others.

    The family name is the last word and what precedes it in lower case. Remarks in parentheses are
    dropped.
    """
    found = []
    for author in _ASIDE.sub("", authors).split(";"):
        words = author.split()
        if not words:
            continue
        if words == ["et", "al."]:
            found.append(("", ""))
            continue
        start = len(words) - 1
        lower = [n for n, word in enumerate(words[:start]) if word[0].islower()]
        start = lower[0] if lower else start
        found.append((" ".join(words[start:]), " ".join(words[:start])))
    return found


def _bibtex(study: Study) -> str:
    kind, venue = _BIBTEX.get(study["type"], ("misc", "howpublished"))
    people = [
        ", ".join(part for part in name if part) if any(name) else "others"
        for name in names(study["authors"])
    ]
    fields = {
        "title": "{" + _escaped(study["title"]) + "}",
        "author": _escaped(" and ".join(people)),
        "year": study["year"],
        venue: _escaped(study["venue"]),
        "doi": study["doi"],
        "url": study["url"],
        "note": _escaped(_SURE.get(study["identity"], study["identity"])),
    }
    lines = "".join(f"  {name} = {{{text}}},\n" for name, text in fields.items() if text)
    return f"@{kind}{{{study['key']},\n{lines}}}\n"


def _escaped(text: str) -> str:
    return "".join(_SPECIAL.get(character, character) for character in text)


def _ris(study: Study) -> str:
    kind, venue = _RIS.get(study["type"], ("GEN", "T2"))
    people = [", ".join(part for part in name if part) for name in names(study["authors"])]
    lines = [
        ("TY", kind),
        ("ID", study["key"]),
        ("TI", study["title"]),
        *(("AU", person or "et al.") for person in people),
        ("PY", study["year"]),
        (venue, study["venue"]),
        ("DO", study["doi"]),
        ("UR", study["url"]),
        ("N1", _SURE.get(study["identity"], study["identity"])),
    ]
    text = "".join(f"{tag}  - {' '.join(value.split())}\n" for tag, value in lines if value)
    return f"{text}ER  - \n"
