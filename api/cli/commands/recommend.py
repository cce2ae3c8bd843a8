"""`sunatlas recommend`: which sensor to build, and how to calibrate it."""

from __future__ import annotations

import typer

from api.cli import architectures
from api.cli.options import Asked, asked_by
from api.cli.prepared_measurements import measure
from api.cli.table_output import Format, FormatOption, emit, emit_json, line_width
from api.cli.wrong_call import refuse
from api.schema.requirements import Requirements
from api.service.problems import Problem
from registry.requirements import PARAMETERS, SETTINGS
from registry.studies import facts

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
@asked_by(
    Requirements,
    *("mission", *PARAMETERS, *SETTINGS, "edition", "sort", "include", "limit", "calibrations"),
)
def recommend(
    *,
    asked: Asked,
    form: FormatOption = Format.TABLE,
) -> None:
    """Rank sensors and calibrations that meet your requirements.

    Lists architectures (detector + mask) whose reported or measured evidence meets all
    requirements, each with its best calibration and the calibration bench that it takes; what
    nobody built comes last. `--include calibrations` lists more of them; CSV has all. If no
    architecture meets the requirements, the requirement that excludes all is named, with changes
    that would help; the exit code is 0.
    """
    from api.service import recommendations as service  # noqa: PLC0415 - NumPy

    wanted = {name: sorted(set(v)) if isinstance(v, list) else v for name, v in asked.items()}
    question = Requirements.model_construct(_fields_set=set(wanted), **wanted)
    try:
        answer = service.ask(question, measure(), facts(question.edition))
    except Problem as problem:
        (wrong,) = problem.errors
        raise refuse(wrong.parameter, wrong.value, wrong.expected, wrong.nearest) from problem
    if form is Format.CSV:
        from api.schema.recommendations import RecommendationRow  # noqa: PLC0415 - many models
        from api.schema.table import columns_of  # noqa: PLC0415 - beside its model

        rows = [row.model_dump() for row in service.rows(answer)]
        emit(rows, columns_of(RecommendationRow), form)
        return
    document = service.document(answer, question, answer.architectures[: question.limit], None)
    if form is Format.JSON:
        emit_json(document.model_dump())
    else:
        typer.echo(architectures.text(document, line_width()), nl=False)
    if document.blocked:
        typer.echo(architectures.explanation(document.blocked, line_width()), err=True)
