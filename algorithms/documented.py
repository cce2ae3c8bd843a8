"""`documented`: complete the docstring of a class from its base classes, the glossary and `about`.

A class describes only what is its own. numpydoc has no inheritance of single parameters.
"""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterable
from functools import cache
from typing import Any, TypeVar

from algorithms import glossary

_Class = TypeVar("_Class", bound=type)
Entries = dict[tuple[str, ...], str]

_HEADING = re.compile(r"^([A-Z][a-z]+)\n-{3,}\n", re.MULTILINE)
_TOPIC = re.compile(r"([A-Z][a-z]+): ")
#: Paragraphs of Notes that a class takes over from its bases, in their order behind its own.
_TOPICS = ("State", "Shapes", "Failure", "Cost")


def documented(cls: _Class) -> _Class:
    """Complete the docstring of an extractor, a compensation or a model.

    Parameters and fitted attributes that the class does not describe are taken from the nearest
    base class that does, else from `algorithms.glossary`; so are the errors raised. Paragraphs of
    Notes on state, shapes, failure and cost are taken from base classes. References are the
    studies and labels of `about` unless the class writes its own.

    Parameters
    ----------
    cls : type
        A dataclass with `about`.

    Returns
    -------
    type
        The same class.
    """
    if cls.__doc__ is None:  # Python runs without docstrings
        return cls
    own = _sections(cls.__doc__)
    others = [_sections(base.__doc__ or "") for base in cls.__mro__[1:-1]]
    shared = [*others, _sections(glossary.__doc__ or "")]
    given = list(inspect.signature(cls).parameters)
    fitted = [field.name for field in dataclasses.fields(cls) if not field.init]
    parts = {
        "Parameters": _described(given, own, shared, "Parameters"),
        "Attributes": _attributes(fitted, own, shared),
        "Raises": own.get("Raises") or _first(shared, "Raises") * bool(given),
        "Notes": _notes(own, others),
        "References": own.get("References") or _references(cls),
        "Examples": own.get("Examples", ""),
    }
    sections = (f"{name}\n{'-' * len(name)}\n{text}\n" for name, text in parts.items() if text)
    cls.__doc__ = "\n".join([own[""] + "\n", *sections])
    return cls


@cache
def _sections(text: str) -> dict[str, str]:
    """Split a docstring by its headings; its beginning has none."""
    lead, *rest = _HEADING.split(inspect.cleandoc(text) + "\n")
    bodies = [body.strip("\n") for body in rest[1::2]]
    return {"": lead.strip(), **dict(zip(rest[::2], bodies, strict=True))}


def _first(sources: Iterable[dict[str, str]], section: str) -> str:
    return next((source[section] for source in sources if section in source), "")


def _entries(body: str) -> Entries:
    """Split a section into its entries by the names that each describes."""
    entries = re.split(r"\n(?=\S)", body) if body else []
    return {tuple(re.split(r",\s*", entry.split(" : ")[0])): entry for entry in entries}


def _described(
    names: list[str], own: dict[str, str], shared: list[dict[str, str]], section: str
) -> str:
    """Join the nearest description of each name; nothing for a name without one."""
    every = [_entries(source.get(section, "")) for source in [own, *shared]]
    found: Entries = {}
    for name in names:
        for entries in every:
            match = next((key for key in entries if name in key), None)
            if match is not None:
                found[match] = entries[match]
                break
    return "\n".join(found.values())


def _attributes(fitted: list[str], own: dict[str, str], shared: list[dict[str, str]]) -> str:
    """Join the class's own attributes and those of its bases that it does not describe."""
    here = own.get("Attributes", "")
    mine = {name for key in _entries(here) for name in key}
    taken = _described([name for name in fitted if name not in mine], {}, shared, "Attributes")
    return "\n".join(filter(None, [here, taken]))


def _notes(own: dict[str, str], others: list[dict[str, str]]) -> str:
    """Insert the bases' paragraphs on topics that the class leaves out."""
    paragraphs = own["Notes"].split("\n\n") if "Notes" in own else []
    topics = [_topic(paragraph) for paragraph in paragraphs]
    place = len(paragraphs)
    for topic in reversed(_TOPICS):
        if topic in topics:
            place = topics.index(topic)
            continue
        bases = (text for base in others for text in base.get("Notes", "").split("\n\n"))
        taken = next((text for text in bases if _topic(text) == topic), None)
        if taken is not None:
            paragraphs.insert(place, taken)
            topics.insert(place, topic)
    return "\n\n".join(paragraphs)


def _topic(paragraph: str) -> str:
    found = _TOPIC.match(paragraph)
    return found[1] if found else ""


def _references(cls: Any) -> str:
    studies, labels = ", ".join(cls.about.studies), ", ".join(cls.about.labels)
    if studies and labels:
        return f"{studies}; survey {labels}."
    if labels:
        return f"Survey {labels}."
    return f"{studies}." if studies else "None of the survey: ours."
