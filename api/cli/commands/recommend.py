"""`sunatlas recommend`: which sensor to build, and how to calibrate it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import typer

from api.cli import architectures
from api.cli.options import Asked, asked_by
from api.cli.prepared_measurements import measure
from api.cli.table_output import Format, FormatOption, emit, emit_json, line_width
from api.cli.wrong_call import refuse
from api.recommending import rows
from api.schema.requirements import Requirements
from registry.recommendation import recommend as ranked
from registry.requirements import PARAMETERS, SETTINGS
from registry.studies import facts
from registry.taxonomy import InvalidValueError

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command()
@asked_by(Requirements, *PARAMETERS, *SETTINGS, "edition", "sort", "limit", "calibrations")
def recommend(
    *,
    asked: Asked,
    form: FormatOption = Format.TABLE,
) -> None:
    """Rank sensors and calibrations that meet your requirements.

    Lists architectures (detector + mask) with their calibrations (extractor + compensations +
    model) and three kinds of evidence: advised by the survey, used in studies, measured here. The
    measured error is the RMS error over the required field of view, in the worst required
    condition. Contradictions between the kinds of evidence are reported. If no architecture meets
    the requirements, the requirement that excludes all is named, with changes that would help; the
    exit code is 0.
    """
    document = _document(asked)
    if form is Format.JSON:
        emit_json(document)
        return
    if form is Format.CSV:
        from api.schema.recommendations import RecommendationRow  # noqa: PLC0415 - many models
        from api.schema.table import columns_of  # noqa: PLC0415 - beside its model

        emit(list(rows(document)), columns_of(RecommendationRow), form)
    else:
        typer.echo(architectures.text(document, line_width()), nl=False)
    if document["blocked"]:
        typer.echo(architectures.explanation(document["blocked"], line_width()), err=True)


def _document(asked: Asked) -> Mapping[str, Any]:
    """Answer as GET /v1/recommendations does, without the service: that takes a second to load."""
    shown = {name: asked.pop(name) for name in ("sort", "limit", "calibrations")}
    studies = facts(asked.pop("edition"))
    wanted = {name: sorted(set(v)) if isinstance(v, list) else v for name, v in asked.items()}
    try:
        return ranked(wanted, measure(), facts=studies, **shown).document
    except InvalidValueError as error:
        raise refuse(error.parameter, error.value, error.expected, error.nearest) from error
