"""Words that a shell completes: names of what is published, values of the survey.

They are read from the files themselves, as importing what they name takes longer than anybody waits
for a key to answer. A data set or an implementation that is not published yet is not among them.
"""

from __future__ import annotations

import csv
import json
import os
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path

Complete = Callable[[str], list[str]]

VARIABLE = "_SUNATLAS_COMPLETE"  # that a shell sets when it asks
_ROOT = Path(__file__).resolve().parents[2]
_PUBLISHED = _ROOT / "benchmark" / "published"


def _completes(words: Callable[[], list[str]]) -> Complete:
    def complete(incomplete: str) -> list[str]:
        return [_quote(word) for word in words() if word.startswith(incomplete)]

    return complete


def _quote(word: str) -> str:
    """Return a word as it is typed: bash takes what is completed as it is."""
    return word.replace(" ", "\\ ") if os.environ.get(VARIABLE) == "complete_bash" else word


@cache
def _components() -> dict[str, dict[str, object]]:
    found: dict[str, dict[str, object]] = json.loads((_PUBLISHED / "components.json").read_bytes())
    return found


@cache
def _column(file: str, column: str, **where: str) -> list[str]:
    with (_ROOT / file).open(encoding="utf-8", newline="") as lines:
        rows = csv.DictReader(lines)
        found = (r[column] for r in rows if all(r[name] == value for name, value in where.items()))
        return list(dict.fromkeys(found))


def _published(kind: str) -> list[str]:
    return sorted(_components()[kind])


def values(attribute: str) -> Complete:
    """Complete the values of an attribute of studies."""
    return _completes(partial(_column, "survey_data/taxonomy.csv", "value", attribute=attribute))


datasets = _completes(partial(_published, "datasets"))
extractors = _completes(partial(_published, "extractors"))
models = _completes(partial(_published, "models"))
conditions = _completes(partial(_column, "benchmark/published/pins.csv", "condition"))
studies = _completes(
    lambda: [
        key
        for table in ("studies.csv", "extension/studies.csv")
        for key in _column(f"survey_data/{table}", "key")
    ]
)
claims = _completes(partial(_column, "survey_data/claims.csv", "id"))
methods = _completes(partial(_column, "survey_data/feature_assessment.csv", "extractor"))
properties = _completes(partial(_column, "survey_data/feature_assessment.csv", "property"))


def one_of(*words: str) -> Complete:
    """Complete one of these words."""
    return _completes(lambda: list(words))
