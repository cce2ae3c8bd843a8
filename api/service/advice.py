"""Advice of the survey, and rules for studies and scores."""

from __future__ import annotations

import tomllib
from pathlib import Path

import survey_data
from api.schema.advice import Advice, AdviceQuery, Statement
from api.schema.table import columns_of
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge
from api.service.pagination import narrow
from benchmark.leaderboard.scope import LEADING, UNITS
from benchmark.metrics.rings import ANSWERED, FEWEST
from benchmark.metrics.score import AVAILABLE, METRIC_VERSION
from survey_data import labels

_SCORES = Path(__file__).with_name("protocol.toml")


def advice(known: Knowledge, query: AdviceQuery) -> Document:
    """List the sensors and calibrations that the survey's text recommends, and for which tasks.

    Rows of errors name errors that occur, which is no recommendation.
    """
    found = narrow(known.advice, query, ("requirement", "detector", "mask"))
    return listing(found, "/v1/advice", query, Advice)


def protocol() -> Document:
    """Describe how the survey selected studies, and the rules of the scores.

    CSV: a row per sentence.
    """
    table = survey_data.load().protocol
    columns = (table[name] for name in ("kind", "id", "text", "survey_section"))
    document = {
        "survey": [_statement("survey", *row) for row in zip(*columns, strict=True)],
        "scores": [
            _statement("scores", one["kind"], one["id"], _filled(one["text"]), "")
            for one in tomllib.loads(_SCORES.read_text("utf-8"))["statement"]
        ],
    }
    return Document(
        document, columns_of(Statement), lambda: [*document["survey"], *document["scores"]]
    )


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


def _statement(about: str, kind: str, identifier: str, text: str, section: str) -> dict[str, str]:
    return {
        "about": about,
        "kind": kind,
        "id": identifier,
        "text": text,
        "section": section,
        "section_name": labels.name(section),
    }
