"""Scores, sweeps on reference features and learning curves, as they are published."""

from __future__ import annotations

from api.schema.assessment import Sweep, SweepsQuery
from api.schema.curves import CurveRow, CurvesQuery
from api.schema.scores import Score, ScoresQuery
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge
from api.service.pagination import narrow


def results(known: Knowledge, query: ScoresQuery) -> Document:
    """Return scores: a row per data set, condition, extractor and model, including failures."""
    names = ("dataset", "condition", "extractor", "model")
    return listing(narrow(known.measurements.scores, query, names), "/v1/results", query, Score)


def sweeps(known: Knowledge, query: SweepsQuery) -> Document:
    """Return the error of every extractor against noise, feature size, sub-pixel phase and more.

    The features are known in closed form; each point has its Cramer-Rao bound. A row without a
    sweep gives the reason why an extractor is not measured.
    """
    rows = narrow(known.measurements.sweeps, query, ("series", "sweep", "extractor"))
    return listing(rows, "/v1/sweeps", query, Sweep)


def curves(known: Knowledge, query: CurvesQuery) -> Document:
    """Error against number of calibration poses, three leading pipelines of each data set.

    Each is calibrated on random subsets of the poses, on two sensor units, and scored on the whole
    test split. CSV: a row per pipeline, without the points.
    """
    rows = narrow(known.measurements.curves, query, ("dataset", "extractor", "model"))
    return listing(rows, "/v1/curves", query, CurveRow)
