"""The form of a GitHub issue that offers a study, and what comes of it: a template.

``python -m survey_data.additions.issue_form --form`` prints the form as it stands in
`.github/ISSUE_TEMPLATE/`; with ``EVENT.json STUDY.toml`` it writes the template of an issue that
was filed with it. Whoever files an issue may write anything in it: its text is only ever data.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from files.atomic import replace_file
from files.reading import FileRefusedError
from files.strict_json import read_json
from survey_data.additions.faults import Fault, FaultsError
from survey_data.additions.vocabulary import Definition, Vocabulary, vocabulary
from survey_data.problems import SurveyImportError

_MOST_CHARACTERS = 65_536  # of an issue's body, by GitHub
_EMPTY = frozenset({"_No response_", "None", ""})
_INPUTS = {
    "key": ("Key", "Surname of the first author in plain letters, then the year: Herman2025."),
    "title": ("Title", "As printed."),
    "authors": ("Authors", "First name first, separated by semicolons."),
    "year": ("Year", "Of the publication."),
    "venue": ("Venue", "Journal, conference, repository or school; volume and pages."),
    "doi": ("DOI", "Of the study, without https://doi.org/."),
    "url": ("Address", "Page of the publisher or the repository. A DOI or an address is needed."),
    "note": ("Remark", "Anything a reader should know."),
}
_REQUIRED = frozenset({"key", "title", "authors", "year"})
_DROPDOWNS = {"type": "Kind of publication", "identity": "How sure is the publication"}
_LINE = """\
One value a line: value | basis | source | note. Basis: {bases}. A source (address or DOI) is needed
with full-text and abstract, a note with inferred and recalled. Leave the field empty where nothing
is known."""
_METHOD = """\
After the value may stand [proposed] or [compared], then (in the study: NAME) for what the study
calls it, or (nearest to: NAME) where the list has no such value and this is only the nearest."""
_NEAREST, _NAMED = "(nearest to:", "(in the study:"
_ROLES = ("proposed", "compared")


def form(known: Vocabulary) -> str:
    """Return the issue form, as GitHub takes it (YAML)."""
    import yaml  # noqa: PLC0415 - only the form is YAML

    body: list[dict[str, Any]] = [
        {
            "type": "markdown",
            "attributes": {
                "value": "For a study that the survey does not map. A job reads the form and opens "
                "a pull request with its row, or answers with what has to be corrected; then edit "
                "the form. The guide explains every field: docs/guide/add-a-study.md."
            },
        }
    ]
    for name in (*_INPUTS, *_DROPDOWNS):
        if name == "note":
            continue
        body.append(_dropdown(name, known) if name in _DROPDOWNS else _input(name))
    body += [_textarea(definition, known) for definition in known.definitions.values()]
    body.append(_input("note"))
    document = {
        "name": "A study is missing",
        "description": "A study that the survey does not map.",
        "title": "Study: ",
        "labels": ["study"],
        "body": body,
    }
    text: str = yaml.safe_dump(document, sort_keys=False, allow_unicode=True, width=98)
    return "# Written by `python -m survey_data.additions.issue_form --form`.\n" + text


def template_of(body: str, known: Vocabulary) -> str:
    """Return the template that the body of an issue fills in.

    Parameters
    ----------
    body : as GitHub writes what was filled in: a heading a field, and its text
    known : attributes and their words

    Raises
    ------
    FaultsError
        It was not made with the form: a heading is missing, stands twice, or is unknown.
    """
    if len(body) > _MOST_CHARACTERS:
        raise FaultsError("issue", [Fault(None, f"longer than {_MOST_CHARACTERS} characters")])
    fields = _fields(body, known)
    lines = []
    for name in (*_INPUTS, *_DROPDOWNS):
        said = " ".join(fields[name].split())
        if name == "authors":
            names = [part.strip() for part in said.split(";")]
            lines.append(f"authors = [{', '.join(_text(n) for n in names if n)}]")
        elif said:
            lines.append(f"{name} = {_text(said)}")
    for attribute in known.definitions:
        for line in fields[attribute].splitlines():
            if line.strip():
                lines += ["", f"[[{attribute}]]", *_value(line)]
    return "\n".join(lines) + "\n"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the form, or write the template of an issue; exit code 1 for what is none."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--form", action="store_true", help="print the form")
    parser.add_argument("event", nargs="?", type=Path, help="JSON of the event, with issue.body")
    parser.add_argument("template", nargs="?", type=Path, help="file to write")
    options = parser.parse_args(arguments)
    known = vocabulary()
    if options.form:
        sys.stdout.write(form(known))
        return 0
    if options.template is None:
        parser.error("expected EVENT.json and STUDY.toml, or --form")
    try:
        replace_file(options.template, template_of(_body(options.event), known))
    except (SurveyImportError, FileRefusedError, OSError) as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return 0


def _label(name: str, known: Vocabulary) -> str:
    if name in known.definitions:
        return known.definitions[name].name
    return _DROPDOWNS.get(name) or _INPUTS[name][0]


def _input(name: str) -> dict[str, Any]:
    label, said = _INPUTS[name]
    return {
        "type": "input",
        "id": name,
        "attributes": {"label": label, "description": said},
        "validations": {"required": name in _REQUIRED},
    }


def _dropdown(name: str, known: Vocabulary) -> dict[str, Any]:
    return {
        "type": "dropdown",
        "id": name,
        "attributes": {"label": _DROPDOWNS[name], "options": list(known.words[name])},
        "validations": {"required": True},
    }


def _textarea(definition: Definition, known: Vocabulary) -> dict[str, Any]:
    bases = ", ".join(name for name in known.bases if name != "unknown")
    if definition.words:
        allowed = "; ".join(
            value if name == value else f"{value} ({name})"
            for value, name in definition.words.items()
        )
        said = f"{_LINE.format(bases=bases)} {_METHOD} Values: {allowed}."
    else:
        said = f"{_LINE.format(bases=bases)} A number of degrees."
    return {
        "type": "textarea",
        "id": definition.attribute,
        "attributes": {
            "label": definition.name,
            "description": f"{definition.description}. {' '.join(said.split())}",
        },
    }


def _fields(body: str, known: Vocabulary) -> dict[str, str]:
    """Return what was filled in, by field; a heading of the form stands alone on its line."""
    names = {f"### {_label(name, known)}": name for name in _names(known)}
    found: dict[str, list[str]] = {}
    faults: list[Fault] = []
    at: list[str] = []
    for line in body.splitlines():
        name = names.get(line.strip())
        if name is None:
            at.append(line)
        elif name in found:
            faults.append(Fault(None, f"the heading {line.strip()!r} stands twice"))
        else:
            at = found[name] = []
    missing = [heading for heading, name in names.items() if name not in found]
    if missing:
        faults.append(Fault(None, f"the headings of the form are missing: {', '.join(missing)}"))
    if faults:
        raise FaultsError("issue", faults)
    texts = {name: "\n".join(lines).strip() for name, lines in found.items()}
    return {name: "" if text in _EMPTY else text for name, text in texts.items()}


def _names(known: Vocabulary) -> Iterator[str]:
    yield from (*_INPUTS, *_DROPDOWNS, *known.definitions)


def _value(line: str) -> Iterator[str]:
    """Give the lines of one table of the template."""
    parts = [part.strip() for part in line.split("|", 3)]
    value, *evidence = parts
    cells: dict[str, str] = {}
    nearest = _NEAREST in value
    if value.endswith(")"):
        before, mark, name = value.partition(_NEAREST if nearest else _NAMED)
        if mark:
            value, cells["name"] = before.strip(), name[:-1].strip()
    for role in _ROLES:
        if value.endswith(f"[{role}]"):
            value, cells["role"] = value.removesuffix(f"[{role}]").strip(), role
    cells = {"value": value, **cells}
    cells |= dict(zip(("basis", "source", "note"), evidence, strict=False))
    yield from (f"{name} = {_text(said)}" for name, said in cells.items() if said)
    if nearest:
        yield "nearest = true"


def _text(value: str) -> str:
    """Return a text as a TOML basic string, whose escapes are those of JSON."""
    return json.dumps(value, ensure_ascii=False)


def _body(path: Path) -> str:
    event = read_json(path)
    issue: Any = event.get("issue") if isinstance(event, Mapping) else None
    body = issue.get("body") if isinstance(issue, Mapping) else None
    if not isinstance(body, str):
        raise FaultsError(path.name, [Fault(None, "expected an event with the body of an issue")])
    if not body.isascii() and any("\ud800" <= letter <= "\udfff" for letter in body):
        raise FaultsError(path.name, [Fault(None, "the body holds half a character (surrogate)")])
    return body


if __name__ == "__main__":
    sys.exit(main())
