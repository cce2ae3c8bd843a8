"""Lint the prose that readers meet: `python -m tools.prose`.

Proselint's checks, words that the glossary avoids, and phrases of `phrases.csv`, over README,
CONTRIBUTING, docs, templates, help of commands and the descriptions of the HTTP API.
"""

from __future__ import annotations

import csv
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bs4 import BeautifulSoup
from markdown_it import MarkdownIt
from proselint.checks import __register__ as checks
from proselint.config import DEFAULT, Config
from proselint.registry import CheckRegistry
from proselint.registry.checks import Check
from proselint.registry.checks.types import PreferredFormsSimple
from proselint.tools import LintFile

from api.glossary import words

ROOT = Path(__file__).resolve().parents[1]
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "docs/**/*.md")
TEMPLATES = "api/pages/templates/**/*.html"
#: Checks that take terms of this field, names of studies or typewriter signs for faults.
_OFF = (
    *("annotations", "typography", "dates_times", "restricted", "social_awareness", "spelling"),
    *("hedging", "uncomparables", "weasel_words", "terms", "cliches.misc"),
    *(f"misc.{name}" for name in ("composition", "phrasal_adjectives", "waxed", "but")),
    *(f"misc.{name}" for name in ("tense_present", "capitalization", "institution_name")),
    *(f"misc.{name}" for name in ("currency", "narcissism", "apologizing")),
)
#: A letter or digit twice is of a formula, no repeated word.
_SYMBOLS = re.compile(r"'(\w) \1'", re.IGNORECASE)
_JINJA = re.compile(r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}", re.DOTALL)


def texts() -> Iterator[tuple[str, str]]:
    """Give each text with its place: a file with a line, a command or an operation."""
    for path in sorted({path for pattern in DOCUMENTS for path in ROOT.glob(pattern)}):
        where = path.relative_to(ROOT).as_posix()
        yield from ((f"{where}:{line}", text) for line, text in markdown(path.read_text("utf-8")))
    for path in sorted(ROOT.glob(TEMPLATES)):
        where = path.relative_to(ROOT).as_posix()
        yield from ((where, line) for line in template(path.read_text("utf-8")).splitlines())
    yield from _help_texts()
    yield from _openapi()


def markdown(page: str) -> Iterator[tuple[int, str]]:
    """Give paragraphs, headings, items and cells of a page, without code and marks."""
    line = 0
    for token in MarkdownIt("commonmark").enable("table").parse(page):
        line = token.map[0] + 1 if token.map else line
        if token.type == "inline":
            kinds = {"text": None, "softbreak": "\n", "code_inline": "…"}
            parts = (one for one in token.children or () if one.type in kinds)
            yield line, "".join(kinds[one.type] or one.content for one in parts)


def template(page: str) -> str:
    """Return the fixed text of a page, a mark where a value is filled in."""
    filled = _JINJA.sub(lambda at: "…" if at[0].startswith("{{") else "\n", page)
    soup = BeautifulSoup(filled, "html.parser")
    for silent in soup(["script", "style", "svg", "code", "math"]):
        silent.replace_with("…")
    return re.sub(r"\s*\n\s*", "\n", soup.get_text())


def _help_texts() -> Iterator[tuple[str, str]]:
    from api.cli.command_line import COMMANDS, load

    def walk(name: str, command: Any) -> Iterator[tuple[str, str]]:
        yield name, command.help or ""
        for option in command.params:
            yield f"{name} {option.opts[0]}", getattr(option, "help", None) or ""
        for below, sub in getattr(command, "commands", {}).items():
            yield from walk(f"{name} {below}", sub)

    for name in COMMANDS:
        yield from walk(f"sunatlas {name}", load(name))


def _openapi() -> Iterator[tuple[str, str]]:
    from api.server.app import create_app

    document = create_app().openapi()
    described = [operation for item in document["paths"].values() for operation in item.values()]
    shared = document.get("components", {}).get("parameters", {}).values()
    for one in described:
        yield from ((one["operationId"], one.get(name, "")) for name in ("summary", "description"))
    parameters = [p for one in described for p in one.get("parameters", ()) if "name" in p]
    yield from (
        (f"parameter {p['name']}", p.get("description", "")) for p in (*parameters, *shared)
    )


def faults(text: str) -> list[str]:
    """Return what proselint, the glossary and the phrases say of a text."""
    registry = CheckRegistry()
    if not registry.checks:
        registry.register_many((*checks, *_vocabulary()))
    enabled = {**DEFAULT["checks"], "glossary": True, "phrases": True, **dict.fromkeys(_OFF, False)}
    specific_first = dict(sorted(enabled.items(), key=lambda item: -item[0].count(".")))
    config = Config(max_errors=20, checks=specific_first)
    found = (
        one.check_result for one in LintFile("text", re.sub(r"`[^`]*`", "…", text)).lint(config)
    )
    said = (f"{one.message} ({one.check_path})" for one in found)
    return [one for one in said if not _SYMBOLS.search(one)]


def _vocabulary() -> tuple[Check, ...]:
    """Return what not to say, and what to say instead, as checks of proselint."""
    terms = {avoided.lower(): one.term for one in words() for avoided in one.avoided}
    with Path(__file__).with_name("phrases.csv").open(encoding="utf-8", newline="") as file:
        phrases = {row["phrase"]: row["say"] for row in csv.DictReader(file)}
    return tuple(
        Check(
            check_type=PreferredFormsSimple(items=items), path=path, message="Say '{}', not '{}'."
        )
        for path, items in (("glossary", terms), ("phrases", phrases))
    )


def main() -> int:
    """Print every fault; the exit code is 1 if there are any."""
    said = [f"{where}: {fault}\n" for where, text in texts() if text for fault in faults(text)]
    sys.stdout.writelines(said)
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
