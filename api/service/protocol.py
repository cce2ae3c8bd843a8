"""How the survey chose its studies, and how scores come about: sentences, each with an id."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

import survey_data
from benchmark.leaderboard.scope import LEADING, UNITS
from benchmark.metrics.rings import ANSWERED, FEWEST
from benchmark.metrics.score import AVAILABLE, METRIC_VERSION
from survey_data import labels

Statement = Mapping[str, str]

_SCORES = Path(__file__).with_name("protocol.toml")


def protocol() -> dict[str, list[Statement]]:
    """Return the survey's protocol and that of the scores.

    Returns
    -------
    dict
        ``survey`` and ``scores``: statements with ``about`` (the same words), ``kind``, ``id``,
        ``text``, ``section`` of the survey and ``section_name`` (empty for scores).
    """
    table = survey_data.load().protocol
    columns = (table[name] for name in ("kind", "id", "text", "survey_section"))
    return {
        "survey": [_statement("survey", *row) for row in zip(*columns, strict=True)],
        "scores": [
            _statement("scores", one["kind"], one["id"], _filled(one["text"]), "")
            for one in tomllib.loads(_SCORES.read_text("utf-8"))["statement"]
        ],
    }


def _filled(text: str) -> str:
    """Return a statement on one line, with the numbers that the code goes by."""
    return " ".join(text.split()).format(
        leading=LEADING,
        units=UNITS,
        metric_version=METRIC_VERSION,
        fewest=FEWEST,
        answered_percent=100 * ANSWERED,
        available_percent=100 * AVAILABLE,
    )


def _statement(about: str, kind: str, identifier: str, text: str, section: str) -> Statement:
    return {
        "about": about,
        "kind": kind,
        "id": identifier,
        "text": text,
        "section": section,
        "section_name": labels.name(section),
    }
