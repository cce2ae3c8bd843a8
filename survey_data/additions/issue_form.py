"""The form of a GitHub issue that offers a study: the template, to be filled in there.

``python -m survey_data.additions.issue_form --form`` prints the form as it stands in
`.github/ISSUE_TEMPLATE/`; with ``EVENT.json STUDY.toml`` it writes the template of an issue that
was filed with it. Whoever files an issue may write anything in it: its text is only ever data.
"""

from __future__ import annotations

import argparse
import re
import sys
import textwrap
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from files.atomic import replace_file
from files.reading import FileRefusedError, read_json
from survey_data.additions.offered import Fault, FaultsError
from survey_data.additions.template import empty_template
from survey_data.problems import SurveyImportError

_MOST_CHARACTERS = 65_536  # of an issue's body, by GitHub
#: What GitHub puts around the text of a field that is rendered as TOML.
_FENCED = re.compile(r"^```toml\n(.*)^```\s*\Z", re.DOTALL | re.MULTILINE)
_FORM = """\
# Written by `python -m survey_data.additions.issue_form --form`.
name: A study is missing
description: A study that the survey does not map.
title: 'Study: '
labels:
- study
body:
- type: markdown
  attributes:
    value: 'For a study that the survey does not map. Fill in the template; every word that it
      takes stands in its comments. A job reads it and opens a pull request, or answers with what
      has to be corrected; then edit the issue. The guide explains it: docs/guide/add-a-study.md.'
- type: textarea
  id: study
  attributes:
    label: The study
    render: toml
    value: |
{template}  validations:
    required: true
"""


class _Issue(BaseModel):
    body: str


class _Event(BaseModel):
    issue: _Issue


def form() -> str:
    """Return the issue form, as GitHub takes it (YAML)."""
    return _FORM.format(template=textwrap.indent(empty_template(), " " * 6))


def template_of(event: Any) -> str:
    """Return the template that an issue fills in, of its event's JSON; FaultsError without one."""
    try:
        body = _Event.model_validate(event).issue.body
    except ValidationError:
        body = ""
    found = _FENCED.search(body.replace("\r\n", "\n"))
    if found is None or len(found[1]) > _MOST_CHARACTERS:
        message = f"expected a study in the form, between ```toml and ```, of {_MOST_CHARACTERS} "
        raise FaultsError("issue", [Fault(None, message + "characters at most")])
    if re.search("[\ud800-\udfff]", found[1]):
        raise FaultsError("issue", [Fault(None, "the body holds half a character (surrogate)")])
    return found[1]


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the form, or write the template of an issue; exit code 1 for what is none."""
    parser = argparse.ArgumentParser(description=main.__doc__)
    parser.add_argument("--form", action="store_true", help="print the form")
    parser.add_argument("event", nargs="?", type=Path, help="JSON of the event, with issue.body")
    parser.add_argument("template", nargs="?", type=Path, help="file to write")
    options = parser.parse_args(arguments)
    if options.form:
        sys.stdout.write(form())
        return 0
    if options.template is None:
        parser.error("expected EVENT.json and STUDY.toml, or --form")
    try:
        replace_file(options.template, template_of(read_json(options.event)))
    except (SurveyImportError, FileRefusedError, OSError) as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
