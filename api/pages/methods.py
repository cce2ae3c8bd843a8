"""What the code of an algorithm says of itself: its docstring in parts, as pages show it."""

from __future__ import annotations

import inspect
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

from markupsafe import Markup

from api.addresses import study_page
from api.mathml import mathml
from api.pages.formulas import tex
from api.pages.terms import marked, term_label
from registry.studies import facts
from survey_data import labels

_HEADING = re.compile(r"^(\w[\w ]+)\n-{3,}\n", re.MULTILINE)
#: Characters of a formula that stands within a line; a longer one may have to be scrolled.
_SHORT = 36
_WORD = re.compile(r"[A-Za-z]+\d{4}[a-z]?")
#: A literal; of a formula also the stop or comma behind it, which would else start a line.
_LITERAL = re.compile(r"``([^`]+)``([.,;:]?)|`([^`]+)`")


@dataclass(frozen=True)
class DocstringParts:
    """A docstring in parts; each text is paragraphs.

    Attributes
    ----------
    name, module, cls : of the class
    lead : what it does
    equations : what it implements, with the survey's labels
    notes : further notes, such as shapes, failure and cost
    parameters : (name, type, text)
    example : a session that runs as it stands
    """

    name: str
    module: str
    cls: str
    lead: tuple[Markup, ...]
    equations: tuple[Markup, ...]
    notes: tuple[Markup, ...]
    parameters: tuple[tuple[str, str, Markup], ...]
    example: str


@cache
def docstring_parts(implementation: Any) -> tuple[DocstringParts, ...]:
    """Return what a class, or each stage of a chain, says of itself."""
    stages = getattr(implementation, "stages", (implementation,))
    return tuple(_docstring_parts(stage) for stage in stages)


def _docstring_parts(cls: Any) -> DocstringParts:
    lead, sections = _sections(inspect.getdoc(cls) or "")
    notes = _paragraphs(sections.get("Notes", ""))
    at = next((k for k, text in enumerate(notes) if text.startswith("Implements")), None)
    # What follows the equations belongs to them, up to the paragraph that names shapes.
    end = next((k for k, text in enumerate(notes) if text.startswith("Shapes")), len(notes))
    equations = notes[at:end] if at is not None else []
    rest = notes[:at] + notes[end:] if at is not None else notes
    return DocstringParts(
        name=cls.about.name,
        module=cls.__module__,
        cls=cls.__name__,
        lead=tuple(map(mark_up, _paragraphs(lead))),
        equations=tuple(map(mark_up, equations)),
        notes=tuple(map(mark_up, rest)),
        parameters=tuple(_parameters(sections.get("Parameters", ""))),
        example=sections.get("Examples", "").strip(),
    )


def _sections(text: str) -> tuple[str, dict[str, str]]:
    lead, *rest = _HEADING.split(text)
    return lead, dict(zip(rest[::2], rest[1::2], strict=True))


def _paragraphs(text: str) -> list[str]:
    return [" ".join(part.split()) for part in re.split(r"\n\s*\n", text.strip()) if part.strip()]


def mark_up(text: str) -> Markup:
    """Return a text of a docstring: formulas typeset, other literals as code, studies linked."""
    return marked(_LITERAL, text, _literal, _link)


def _literal(found: re.Match[str]) -> Markup:
    if found[1]:
        return _formula(found[1], found[2])
    if found[3] in labels.labels():
        return term_label(found[3])
    return Markup("<code>{}</code>").format(found[3])


def _formula(text: str, stop: str) -> Markup:
    """Return a formula as MathML, one that is long on a line of its own; code where it is none."""
    written = tex(text)
    if written is None:
        return Markup("<code>{}</code>{}").format(text, stop)
    drawn = Markup(mathml(written)).replace(  # noqa: S704 - made here, of names that are letters
        'display="inline"', Markup('displaystyle="true" alttext="{}"').format(text)
    )
    if len(text) <= _SHORT:
        return Markup('<span class="formula">{}{}</span>').format(drawn, stop)
    return Markup('<span class="formula long" tabindex="0">{}{}</span>').format(drawn, stop)


def _link(text: str) -> Markup:
    """Return a text with links to the studies that it names, and of labels to what they are."""
    studies = facts("all").studies

    def linked(found: re.Match[str]) -> Markup:
        if found[0] not in studies:
            return Markup.escape(found[0])
        return Markup('<a href="{}">{}</a>').format(study_page(found[0]), found[0])

    return marked(_WORD, text, linked, term_label)


def _parameters(text: str) -> list[tuple[str, str, Markup]]:
    found: list[tuple[str, str, list[str]]] = []
    for line in text.splitlines():
        if line and not line[0].isspace():
            name, _, kind = line.partition(" : ")
            found.append((name, kind, []))
        elif found:
            found[-1][2].append(line.strip())
    return [(name, kind, mark_up(" ".join(lines).strip())) for name, kind, lines in found]
