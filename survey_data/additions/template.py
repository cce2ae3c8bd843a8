"""Writing a study's template: empty, with every word that may stand in it, or filled with rows."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from survey_data.additions.addition_reader import Row
from survey_data.additions.vocabulary import Definition, Vocabulary
from survey_data.descriptor import column_types

_HEAD = """\
# A study for `sunatlas survey add FILE`. Fill in what you know and take away the rest: an attribute
# without a [[table]] is unknown, and so is one with the basis "unknown" (its note says why).
# Lines that start with # say nothing; take the # away where a line shall count.
"""
_PUBLICATION = {
    "key": "surname of the first author (plain letters), year, a letter where the key is taken",
    "title": "as printed",
    "authors": 'a list: ["First Last", "First Last"]',
    "year": "as in the key",
    "venue": "journal, conference, repository or school, then volume and pages",
    "doi": "without https://doi.org/; a DOI or a url is needed",
    "url": "page of the publisher or the repository, no mirror",
    "note": "a remark",
}
_IDENTITIES = "confirmed: you saw the page; recalled: from memory"
_EVIDENCE = """\
# ---- The attributes: one [[table]] a value, as many as there are.
#   value     from the list above it, or a number
#   basis     {bases}
#   source    address or DOI of what was read; needed with full-text and abstract
#   note      the words or the reason; needed with inferred and recalled
#   name      what the study calls it, where that is not the name in the list (optional)
#   nearest   true where the list has no such value and this one is only the nearest: then `name`
#             is needed, and nothing that runs this value counts as the study's own (optional)
#   role      of a model or an extractor: {roles}; role_note says why (optional)
"""
_SENSORS = """\
# ---- Only where a study has several detectors and several masks: which goes with which.
# [[architecture]]
# detector = ""
# mask = ""
# basis = ""
# source = ""
# note = ""
"""


def empty_template(vocabulary: Vocabulary, publication: Row | None = None) -> str:
    """Return an empty template, with the allowed words in comments.

    Parameters
    ----------
    vocabulary : the words
    publication : what is known of the publication already, by column of the table of studies
    """
    known = publication or {}
    lines = [_HEAD, "# ---- The publication."]
    for column in column_types("extension_studies"):
        words = vocabulary.words.get(column)
        said = ", ".join(words) if words else _PUBLICATION.get(column, "")
        if column == "identity":
            said += f" ({_IDENTITIES})"
        lines += [
            f"# {column}: {said}",
            f"{column} = {_format_value(column, known.get(column, ''))}",
        ]
    bases = "; ".join(f"{name} ({_first(said)})" for name, said in vocabulary.bases.items())
    values = {"bases": "\n#             ".join(_wrap(bases)), "roles": ", ".join(vocabulary.roles)}
    lines += ["", _EVIDENCE.format(**values)]
    for definition in vocabulary.definitions.values():
        lines += [*_of_attribute(definition), ""]
    return "\n".join([*lines, _SENSORS])


def _of_attribute(definition: Definition) -> Iterator[str]:
    """Give the lines of one attribute: what it is, what it may be, an empty table."""
    several = "" if definition.multiple else "; one value"
    yield f"# {definition.attribute}: {definition.description}{several}."
    if definition.words:
        for value, name in definition.words.items():
            yield f"#   {value}" + ("" if name == value else f": {name}")
    else:
        yield f"#   a number from {definition.minimum:g} to {definition.maximum:g}"
    yield f"# [[{definition.attribute}]]"
    yield '# value = ""' if definition.words else "# value ="
    yield from ('# basis = ""', '# source = ""', '# note = ""')


def _format_value(column: str, value: str) -> str:
    """Return a column of the study as TOML."""
    if column == "year":
        return value if re.fullmatch(r"[0-9]{1,4}", value) and value[0] != "0" else _text(value)
    if column == "authors":
        return json.dumps([n for n in value.split("; ") if n], ensure_ascii=False)
    return _text(value)


def _text(value: str) -> str:
    """Return a text as a TOML basic string, whose escapes are those of JSON."""
    return json.dumps(value, ensure_ascii=False)


def _first(text: str) -> str:
    """Return the first part of a description, as it stands inside a sentence."""
    said = re.split(r"[;,]", text)[0]
    return said[:1].lower() + said[1:]


def _wrap(text: str, width: int = 82) -> list[str]:
    lines = [""]
    for word in text.split():
        if len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines
