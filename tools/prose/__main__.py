"""Lint the prose that readers meet: `python -m tools.prose`.

Proselint's checks, words that the glossary avoids, phrases of `phrases.csv`, and sentences longer
than `LONGEST` words, over README, CONTRIBUTING, docs, templates, help of commands and the
descriptions of the HTTP API. Text of the survey in quotation marks is left as it is.
"""

from __future__ import annotations

import csv
import re
import sys
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

from proselint.checks import __register__ as checks
from proselint.config import DEFAULT, Config
from proselint.registry import CheckRegistry
from proselint.registry.checks import Check
from proselint.registry.checks.types import PreferredFormsSimple
from proselint.tools import LintFile

from api.glossary import words
from tools.prose.texts import Block, documents, help_texts, openapi, sentences, templates

#: Words of the longest sentence, or of its longest part between semicolons.
LONGEST = 35
#: A number is no word.
_WORD = re.compile(r"[^\W\d][\w'-]*")
_CODE = re.compile(r"`[^`]*`")
#: Text of definitions, tables and names, quoted as the code and the data package have it.
QUOTED = ("docs/assessment.md", "docs/algorithms.md", "docs/guide/data-dictionary.md")
PHRASES = Path(__file__).with_name("phrases.csv")
#: Checks that take terms of this field, names of studies or typewriter signs for faults.
_OFF = (
    *("annotations", "typography", "dates_times", "restricted", "social_awareness", "spelling"),
    *(
        "misc.composition",
        "misc.phrasal_adjectives",
        "misc.waxed",
        "misc.but",
        "misc.tense_present",
    ),
    *("misc.capitalization", "misc.institution_name", "misc.currency", "misc.narcissism"),
    *("misc.apologizing", "hedging", "uncomparables", "weasel_words", "terms", "cliches.misc"),
)


def vocabulary() -> tuple[Check, ...]:
    """Return what not to say, and what to say instead, as checks of proselint."""
    terms = {avoided.lower(): one.term for one in words() for avoided in one.avoided}
    with PHRASES.open(encoding="utf-8", newline="") as file:
        phrases = {row["phrase"]: row["say"] for row in csv.DictReader(file)}
    return tuple(
        Check(
            check_type=PreferredFormsSimple(items=items), path=path, message="Say '{}', not '{}'."
        )
        for path, items in (("glossary", terms), ("phrases", phrases))
    )


def faults(blocks: Iterable[Block]) -> Iterator[tuple[Block, str]]:
    """Give each block with a fault, and the fault."""
    registry = CheckRegistry()
    if not registry.checks:
        registry.register_many((*checks, *vocabulary()))
    enabled = {**DEFAULT["checks"], "glossary": True, "phrases": True, **dict.fromkeys(_OFF, False)}
    config = Config(max_errors=20, checks=_specific_first(enabled))
    for block in blocks:
        if not block.text or block.where in QUOTED:
            continue
        for found in LintFile(block.where, _CODE.sub("…", block.text)).lint(config):
            yield block, f"{found.check_result.message} ({found.check_result.check_path})"
        for sentence in sentences(block.text):
            longest = max(len(_WORD.findall(part)) for part in sentence.split(";"))
            if longest > LONGEST:
                yield block, f"{longest} words without a stop: {sentence[:70]} ..."


def _specific_first(enabled: dict[str, bool]) -> dict[str, bool]:
    return dict(sorted(enabled.items(), key=lambda item: -item[0].count(".")))


def main() -> int:
    """Print every fault; the exit code is 1 if there are any."""
    count = 0
    for block, said in faults(chain(documents(), templates(), help_texts(), openapi())):
        count += 1
        sys.stdout.write(f"{block.where}:{block.line}: {said}\n")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main())
