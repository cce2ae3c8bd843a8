"""What words mean here: the survey's abbreviations, and the terms of this project.

The survey's come from its taxonomy, with the name in full; the project's own stand in
`glossary.csv`. The guide and the page tell the same.
"""

from __future__ import annotations

import csv
from collections import Counter
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from registry.studies import facts

#: What a value of an attribute is, where the taxonomy tells a name and a category alone.
_KINDS = {
    "model": "Calibration model",
    "extractor": "Feature extractor",
    "task": "Task: what a study set out to improve",
    "error": "Kind of error that a study treats",
    "detector": "Detector",
    "mask": "Mask",
    "accuracy": "Accuracy class",
}


@dataclass(frozen=True)
class Term:
    """A word and its meaning.

    Attributes
    ----------
    term
        As it is written in tables.
    name
        In full.
    meaning
        In one or two sentences.
    kind
        "term" for a word of this project; else the attribute of the survey's that it is a value of.
    see
        Page of the guide, from `docs/`, with an anchor where there is one; empty for none.
    avoided
        Words that are not used for it; the prose linter names them.
    """

    term: str
    name: str
    meaning: str
    kind: str
    see: str
    avoided: tuple[str, ...] = ()


@cache
def glossary() -> tuple[Term, ...]:
    """Return every term, the project's own and the survey's values, by the alphabet.

    A value has its name from the taxonomy, and its meaning from the table where that has it.
    """
    survey = _survey()
    values = {one.term for one in survey}
    own = (one for one in words() if one.term not in values)
    return tuple(sorted((*own, *survey), key=lambda one: (one.term.casefold(), one.kind)))


@cache
def words() -> tuple[Term, ...]:
    """Return the table's terms, by the alphabet."""
    text = (files("api") / "glossary.csv").read_text("utf-8")
    found = []
    for row in csv.DictReader(text.splitlines()):
        avoided = tuple(filter(None, row.pop("avoid").split("; ")))
        found.append(Term(kind="term", avoided=avoided, **row))
    return tuple(sorted(found, key=lambda one: one.term.casefold()))


def _survey() -> tuple[Term, ...]:
    """Return the values of the taxonomy; "None" with what it is none of."""
    taxonomy = facts().taxonomy
    meanings = {one.term: one.meaning for one in words()}
    # One word for a mask and for a model means two things.
    times = Counter(value for attribute in _KINDS for value in taxonomy.values(attribute))
    found = []
    for attribute, kind in _KINDS.items():
        for value in taxonomy.values(attribute):
            name = taxonomy.name(attribute, value)
            category = taxonomy.category(attribute, value)
            if value == "None":
                meaning = f"{kind}: the study has none, or none is needed."
            elif value in meanings and times[value] == 1:
                meaning = meanings[value]
            elif category and category not in {"Sensor goal", "Mask", "Performance", value}:
                meaning = f"{kind}, {category.lower() if attribute != 'model' else category}."
            else:
                meaning = f"{kind}."
            found.append(Term(value, name, meaning, attribute, ""))
    return tuple(found)
