"""How the survey chose its studies, and how scores come about: sentences, each with an id."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import survey_data
from benchmark.leaderboard.scope import LEADING, UNITS
from benchmark.metrics.rings import ANSWERED, FEWEST
from benchmark.metrics.score import AVAILABLE, METRIC_VERSION
from survey_data import labels

Statement = Mapping[str, Any]

_SCORES: Sequence[tuple[str, str, str]] = (
    (
        "data",
        "data-set",
        (
            "A data set is a simulated sensor of one detector behind one mask: a function of "
            "its name, "
            "version and seed, pinned by hashes. Its card names every parameter."
        ),
    ),
    (
        "data",
        "splits",
        (
            "It has a calibration split, taken as on a bench with the bench's own errors or in "
            "flight; "
            "a test split of random directions; and a repeat split of poses held still."
        ),
    ),
    (
        "data",
        "conditions",
        (
            "Each condition changes one thing of the test data, such as albedo or dead pixels; the "
            "first one is nominal, and ranks elsewhere are by it."
        ),
    ),
    (
        "data",
        "units",
        (
            f"Unit 0 is the standard sensor that scores are of. The leading {LEADING} pipelines "
            "of a "
            f"board are scored on {UNITS} units built alike within the stated tolerances."
        ),
    ),
    (
        "pipeline",
        "fit",
        (
            "A pipeline is an extractor, compensations and a model. It is fitted to the "
            "calibration "
            "split alone; settings are chosen there by blocked cross-validation."
        ),
    ),
    (
        "pipeline",
        "refusal",
        "What a pipeline cannot be fitted to is a row without numbers and with the reason.",
    ),
    (
        "metric",
        "error",
        (
            "The error of a sample is the angle between the answer and the true direction; "
            "rms, median "
            "and percentiles are over samples whose direction is observable and that are answered. "
            f"Version of these definitions: {METRIC_VERSION}."
        ),
    ),
    (
        "metric",
        "availability",
        (
            "Availability is the answered share of the observable samples; a false Sun is an "
            "answer to "
            "a sample that is not observable."
        ),
    ),
    (
        "metric",
        "rings",
        (
            "By angle off the boresight, rms errors are given in rings. A ring has an error from "
            f"{FEWEST} observable samples on, {100 * ANSWERED:g} % of them answered. Over part "
            "of the "
            "field, rings count by their solid angle."
        ),
    ),
    (
        "metric",
        "repeatability",
        "Repeatability is the standard deviation of answers to a pose held still.",
    ),
    (
        "bound",
        "bound",
        (
            "The bound is the Cramer-Rao bound of the angle, rms over the same samples, from the "
            "simulator's own derivatives and noise, with the unit known: no unbiased pipeline "
            "is below."
        ),
    ),
    (
        "bound",
        "bound-unit",
        "The second bound knows the unit by flat and dark readings alone.",
    ),
    (
        "bound",
        "floor",
        (
            "The floor is the least accuracy: the root of the squares of the second bound and "
            "of the "
            "systematic error of the calibration's reference."
        ),
    ),
    (
        "rank",
        "order",
        (
            "Pipelines rank by own error within a data set and condition: calibrated with true "
            "directions, over all answers, the geometric mean over sensor units. Those that answer "
            f"less than {100 * AVAILABLE:g} % come behind all others."
        ),
    ),
    (
        "rank",
        "ties",
        (
            "A rank is shared where a paired test of log error ratios over the units, with Holm's "
            "correction and a practical equivalence of 3 %, does not tell pipelines apart."
        ),
    ),
    (
        "time",
        "times",
        (
            "Times are of extraction and prediction of one sample, in one thread on the "
            "machine that "
            "serves, beside a reference; they are no part of what is published."
        ),
    ),
)


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
        "scores": [_statement("scores", *row, "") for row in _SCORES],
    }


def _statement(about: str, kind: str, identifier: str, text: str, section: str) -> Statement:
    return {
        "about": about,
        "kind": kind,
        "id": identifier,
        "text": text,
        "section": section,
        "section_name": labels.name(section),
    }
