"""`sunatlas assess`: the survey's scores of its methods beside the measured ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import typer

from api.cli.asking import ask
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit, emit_answer, say
from api.schema.assessment import AssessmentQuery
from api.service.assessment import assessment
from benchmark.assessment.definitions import DEFINITIONS

COLUMNS = (
    *("method", "taxonomy", "case_study", "property", "survey", "measured", "agreement"),
    *("value", "unit", "extractor", "measured_on", "reason"),
)
_MARKS = {"agrees": "=", "near": "~", "opposed": "x", "not judged": ".", "not measured": "-"}


@asked_by(AssessmentQuery, "method")
def assess(*, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Compare the survey's scores of extractors with ours.

    19 methods and 21 properties, scored 2 (yes), 1 (partly) or 0 (no). A cell shows the survey's
    score, a mark and the measured score: = agrees, ~ differs by one, x differs by two. A dot means
    that the measurement cannot contradict the survey, a dash that it is missing. Values are from
    the published results; /v1/assessment has the definitions. CSV has a row per method and
    property.
    """
    answer = ask(assessment, asked)
    document = answer.document
    if form is not Format.TABLE or asked:
        emit_answer(answer, form, COLUMNS)
        return
    rows = []
    for row in document["methods"]:
        cells = {str(n): _cell(found) for n, found in enumerate(row["properties"], start=1)}
        counts = zip(_MARKS.values(), row["counts"].values(), strict=True)
        rows.append({"method": row["method"], **cells, **dict(counts)})
    shown = ("method", *map(str, range(1, len(DEFINITIONS) + 1)), *_MARKS.values())
    emit(rows, shown, form, title="Survey, mark and measured, by property")
    for number, name in enumerate(DEFINITIONS, start=1):
        say(f"{number} {name}", "   ")
    totals = document["totals"]
    typer.echo("; ".join(f"{name}: {count}" for name, count in totals.items()), err=True)


def _cell(verdict: Mapping[str, Any]) -> str:
    measured = verdict["measured"]
    if measured is None:
        return f"{verdict['survey']} {_MARKS[verdict['agreement']]}"
    return f"{verdict['survey']}{_MARKS[verdict['agreement']]}{measured}"
