"""`sunatlas recommend`: which sensor to build, and how to calibrate it."""

from __future__ import annotations

import typer

from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit, line_width
from api.cli.wrong_call import WrongCallError, given
from api.schema.requirements import Requirements
from registry.requirements import PARAMETERS, SETTINGS


@asked_by(
    Requirements,
    *("mission", *PARAMETERS, *SETTINGS, "edition", "sort", "include", "limit", "cursor"),
    "calibrations",
)
def recommend(context: typer.Context, *, asked: Asked, form: FormatOption = Format.TABLE) -> None:
    """Rank sensors and calibrations that meet your requirements.

    Lists architectures (detector + mask) whose reported or measured evidence meets all
    requirements, each with its best calibration and the calibration bench that it takes; what
    nobody built comes last. `--include calibrations` lists more of them; CSV has all. If no
    architecture meets the requirements, the requirement that excludes all is named, with changes
    that would help; the exit code is 0.
    """
    _refuse_unused(given(context), asked, form)
    from api.cli import architectures  # noqa: PLC0415 - slow, and the help does without it
    from api.cli.asking import ask  # noqa: PLC0415 - as above
    from api.schema.recommendations import Recommendations  # noqa: PLC0415 - many models
    from api.service.recommendations import recommendations  # noqa: PLC0415 - as above

    answer = ask(recommendations, asked)
    document = Recommendations.model_validate(answer.document)
    if form is Format.TABLE:
        typer.echo(architectures.text(document, line_width()), nl=False)
    else:
        rows = answer.rows() if form is Format.CSV else []
        emit(rows, answer.columns, form, document=answer.document)
    if document.blocked:
        typer.echo(architectures.explanation(document.blocked, line_width()), err=True)


def _refuse_unused(options: list[str], asked: Asked, form: Format) -> None:
    """Refuse options that the format, or the others, leave without an effect."""
    included = asked.get("include", ())
    paged = {"--include", "--calibrations", "--limit", "--cursor"}
    if form is Format.CSV and (unused := [name for name in options if name in paged]):
        raise WrongCallError(f"--format csv has every calibration: leave out {', '.join(unused)}")
    if form is Format.TABLE and (more := {"paths", "designs"}.intersection(included)):
        raise WrongCallError(f"--include {min(more)} goes with --format json")
    if "--calibrations" in options and "calibrations" not in included:
        raise WrongCallError("--calibrations goes with --include calibrations")
