"""Terms and their meaning: no abbreviation stands on a page without its meaning a tap away.

`api.glossary` is the one place of terms; values of the taxonomy bring their own names.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache

from markupsafe import Markup

from api.addresses import anchor, study_page, value_page
from api.figures.wording import NONE, display_name, value_name
from api.glossary import Term, words
from registry.studies import facts
from registry.taxonomy import ATTRIBUTES, NOT_IN_SURVEY
from survey_data import labels
from survey_data.reported import KIND_OF, statistics
from survey_data.sources import source_named

_LITERAL = re.compile(r"(?P<quotes>``?)(?P<code>[^`]+)(?P=quotes)")


@cache
def glossary() -> dict[str, Term]:
    """Return the terms by name, in alphabetical order."""
    return {one.term: one for one in words()}


@cache
def _abbreviations() -> re.Pattern[str]:
    """Return what finds terms in a text: those written with capitals, longest first."""
    words = [term for term in glossary() if sum(c.isupper() for c in term) > 1]
    words.sort(key=len, reverse=True)
    return re.compile(rf"(?<![\w/-])(?:{'|'.join(map(re.escape, words))})(?![\w-])")


def term(name: str, text: str | None = None) -> Markup:
    """Return a term with its meaning as a tip, and a link to its entry; others stand bare."""
    known = glossary().get(name)
    if known is None:
        return Markup.escape(text or name)
    link = Markup('<a class="term" href="/glossary#{id}" title="{short}">{text}</a>')
    return link.format(id=anchor("term", name), short=known.name, text=text or name)


def marked(
    pattern: re.Pattern[str],
    text: str,
    mark: Callable[[re.Match[str]], Markup],
    prose: Callable[[str], Markup] = Markup.escape,
) -> Markup:
    """Return a text, what a pattern finds in it by `mark` and the rest by `prose`."""
    parts, at = [], 0
    for found in pattern.finditer(text):
        parts += [prose(text[at : found.start()]), mark(found)]
        at = found.end()
    return Markup("").join([*parts, prose(text[at:])])


def code_markup(text: str, prose: Callable[[str], Markup] = Markup.escape) -> Markup:
    """Return a text, what stands between backquotes as code and the rest by `prose`."""
    code = Markup("<code>{}</code>")
    return marked(_LITERAL, text, lambda found: code.format(found["code"]), prose)


def explain_terms(text: str) -> Markup:
    """Return a text, each abbreviation's first place in it with its meaning, literals as code."""
    met: set[str] = set()

    def explained(found: re.Match[str]) -> Markup:
        name = found.group()
        if name in met:
            return Markup.escape(name)
        met.add(name)
        return term(name)

    def explain(prose: str) -> Markup:
        return marked(_abbreviations(), labels.label_of(prose), explained)

    return code_markup(text, explain)


def display_text(value: str, attribute: str) -> str:
    """Return a value as it is written: the survey's "None" says of what there is none."""
    return display_name(attribute, value)


def term_name(value: str, attribute: str) -> str:
    """Return the name of a value, which stands for its abbreviation."""
    return value_name(facts().taxonomy, attribute, value)


def local_term_name(value: str, attribute: str) -> str:
    """Return the name of a value where it says more than the value does, else nothing."""
    name = term_name(value, attribute) if attribute in ATTRIBUTES else ""
    return "" if name in {value, display_text(value, attribute)} else name


def value(text: str, attribute: str) -> Markup:
    """Return a value of an attribute with its name as a tip, and a link to its description."""
    if attribute in KIND_OF.values():
        return Markup.escape(statistics()[text].name)
    if attribute not in ATTRIBUTES:
        return Markup.escape(text)
    link = Markup('<a class="value" href="{at}" title="{name}">{text}</a>')
    at = value_page(attribute, text)
    return link.format(at=at, name=term_name(text, attribute), text=display_text(text, attribute))


def method_value(text: str, attribute: str) -> Markup:
    """Return the survey's value of an implementation, which for an own method is none."""
    return Markup.escape(NOT_IN_SURVEY) if text == NONE else value(text, attribute)


def term_label(text: str) -> Markup:
    """Return a text, what each label of the survey's source in it names in the label's place."""
    name = labels.name if text in labels.labels() else labels.mention
    shown = Markup('<span title="{}">{}</span>')
    return marked(labels.LABEL, text, lambda found: shown.format(found[0], name(found[0])))


def cite_study(source: str, key: str = "") -> Markup:
    """Return a source by its name: linked where it has an address, or is a study of ours.

    `key` is of the study whose page it stands on, which is not linked to itself.
    """
    if key and source == key:
        return Markup("the publication itself")
    found = source_named(source)
    if found.link:
        link = Markup('<a href="{}" rel="noreferrer">{}</a>')
        return link.format(found.link, found.name)
    if source in facts().studies:
        return Markup('<a href="{}">{}</a>').format(study_page(source), source)
    return term_label(source or "–")


GIVEN = (
    term,
    code_markup,
    explain_terms,
    display_text,
    term_name,
    local_term_name,
    value,
    method_value,
    term_label,
    cite_study,
)
"""What templates are given as filters."""
