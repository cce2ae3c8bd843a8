"""`sunatlas figures`: the numbers and sentences of the figures of measurements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import typer

from api.cli.asking import ask
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit_answer, say
from api.figures.robustness import WORST
from api.figures.trade_off import AXES
from api.schema.measured_figures import GapQuery, RobustnessQuery, TradeOffQuery
from api.service import gap as gaps
from api.service import robustness as robustnesses
from api.service import trade_off as trade_offs
from api.service.documents import Document

app = typer.Typer(add_completion=False, rich_markup_mode=None)

_GAP = ("detector", "mask", "study_rms_deg", "flight_error_deg", "own_error_deg", "bound_deg")
_CELL = ("name", "state", "over_bound", "over_best", "data_sets", "answered")
_PAIR = ("scope", "wins", "ties", "losses", "neither", "ratio", "ratio_low", "ratio_high")


@app.command()
@asked_by(GapQuery, "level", "detector", "mask", "task", "error", "edition")
def gap(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Print reported accuracy, error in flight, own error and bound of every architecture.

    Degrees, RMS. The table has the smallest number of a study; JSON and CSV have all, of built
    sensors too.
    """
    answer = ask(gaps.gap, asked)
    rows = [
        {**row, "study_rms_deg": next(iter(row["study_rms_deg"]), None)} for row in answer.rows()
    ]
    _emit(answer, rows, _GAP, form)


@app.command("trade-off")
@asked_by(
    TradeOffQuery,
    *("across", "level", "detector", "mask", "dataset", "extractor", "model", "select"),
)
def trade_off(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Print errors against a cost, and which pipelines are on the frontier.

    The table has the frontier, what the paired test does not separate from it, and what is
    selected; JSON and CSV have all.
    """
    answer = ask(trade_offs.trade_off, asked)
    near = ("frontier", "not separable")
    rows = [row for row in answer.rows() if row["selected"] or row["status"] in near]
    column = AXES[answer.document["options"]["across"]][0]
    _emit(answer, rows, ("name", "status", "error_deg", column), form)


@app.command()
@asked_by(RobustnessQuery, "rows", "condition", "hazard", "detector", "mask", "compare")
def robustness(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Print multiples of the bound of extractors or models by condition.

    Medians over data sets. The table has the worst of the conditions asked for, else the nominal
    condition; with --compare the wins of the first of two. JSON and CSV have every cell.
    """
    answer = ask(robustnesses.robustness, asked)
    cells = answer.rows()
    shown = WORST if any(row["condition"] == WORST for row in cells) else "nominal"
    rows = [row for row in cells if row["condition"] == shown and row["state"] != "untested"]
    pairs = answer.document["pairwise"]
    _emit(answer, pairs or rows, _PAIR if pairs else _CELL, form)


def _emit(
    answer: Document, rows: Sequence[Mapping[str, Any]], shown: Sequence[str], form: Format
) -> None:
    """Print all rows as JSON or CSV, or some of them as a table with the figure's sentences."""
    emit_answer(answer, form, shown, rows=rows)
    for sentence in answer.document["text"] if form is Format.TABLE else ():
        say(sentence)
