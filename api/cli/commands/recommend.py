"""`sunatlas recommend`: which sensor to build, and how to calibrate it."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from typing import Annotated, Any

import typer

from api.cli import architectures, attributes, completion
from api.cli.prepared_measurements import measure
from api.cli.table_output import Format, FormatOption, emit, emit_json, line_width
from api.cli.wrong_call import refuse
from api.recommending import rows
from api.schema.recommendations import RecommendationRow
from api.schema.table import columns_of
from registry.recommendation import recommend as ranked
from registry.requirements import HAZARDS, NEEDS
from registry.studies import Facts, facts
from registry.taxonomy import InvalidValueError

app = typer.Typer(add_completion=False, rich_markup_mode=None)


class Sort(StrEnum):
    """Which evidence an answer is ordered by first (`registry.ranking.SORTS`)."""

    ADVICE = "advice"
    SUPPORT = "support"
    MEASURED = "measured"


@app.command()
def recommend(
    *,
    task: attributes.Task = None,
    detector: attributes.Detector = None,
    mask: attributes.Mask = None,
    model: attributes.Model = None,
    extractor: attributes.Extractor = None,
    error: attributes.Error = None,
    accuracy: attributes.Accuracy = None,
    exclude_task: attributes.NoTask = None,
    exclude_detector: attributes.NoDetector = None,
    exclude_mask: attributes.NoMask = None,
    exclude_model: attributes.NoModel = None,
    exclude_extractor: attributes.NoExtractor = None,
    exclude_error: attributes.NoError = None,
    exclude_accuracy: attributes.NoAccuracy = None,
    max_error_deg: Annotated[float | None, typer.Option(help="Maximum RMS error, degrees.")] = None,
    min_fov_deg: Annotated[
        float | None, typer.Option(help="Minimum full field of view, degrees.")
    ] = None,
    max_latency_us: Annotated[
        float | None, typer.Option(help="Maximum time per sample, microseconds.")
    ] = None,
    min_availability: Annotated[
        float | None, typer.Option(help="Minimum availability, above 0 to 1.")
    ] = None,
    survive: Annotated[
        list[str] | None,
        typer.Option(
            autocompletion=completion.one_of(*HAZARDS),
            help=f"Condition to tolerate: {', '.join(HAZARDS)}; may be repeated.",
        ),
    ] = None,
    properties: Annotated[
        list[str] | None,
        typer.Option(
            autocompletion=completion.properties,
            help=(
                "Extractor property in the survey's assessment, such as 'Robust to noise'; "
                "may be repeated."
            ),
        ),
    ] = None,
    exclude_needs: Annotated[
        list[str] | None,
        typer.Option(
            autocompletion=completion.one_of(*NEEDS),
            help=f"Exclude calibrations that need this input: {', '.join(NEEDS)}; may be repeated.",
        ),
    ] = None,
    bench_deg: Annotated[
        float | None,
        typer.Option(
            help="Fixed error of the calibration bench, degrees; 0 for own errors.",
            show_default="each data set's standard bench",
        ),
    ] = None,
    confidence: Annotated[
        float | None,
        typer.Option(
            help="Share of sensor units and benches that must meet the maximum error.",
            show_default="0.9",
        ),
    ] = None,
    edition: attributes.EditionOption = attributes.Edition.SURVEY,
    sort: Annotated[Sort, typer.Option(help="Evidence to rank by.")] = Sort.ADVICE,
    limit: Annotated[
        int, typer.Option(min=1, max=500, help="Maximum number of architectures.")
    ] = 20,
    calibrations: Annotated[
        int, typer.Option(min=1, max=500, help="Maximum number of calibrations per architecture.")
    ] = 5,
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
    document = _document(
        {
            "task": task,
            "detector": detector,
            "mask": mask,
            "model": model,
            "extractor": extractor,
            "error": error,
            "accuracy": accuracy,
            "exclude_task": exclude_task,
            "exclude_detector": exclude_detector,
            "exclude_mask": exclude_mask,
            "exclude_model": exclude_model,
            "exclude_extractor": exclude_extractor,
            "exclude_error": exclude_error,
            "exclude_accuracy": exclude_accuracy,
            "max_error_deg": max_error_deg,
            "min_fov_deg": min_fov_deg,
            "min_availability": min_availability,
            "max_latency_us": max_latency_us,
            "survive": survive,
            "properties": properties,
            "exclude_needs": exclude_needs,
            "bench_deg": bench_deg,
            "confidence": confidence,
        },
        sort,
        limit,
        calibrations,
        facts(edition.value),
    )
    if form is Format.JSON:
        emit_json(document)
        return
    if form is Format.CSV:
        emit(list(rows(document)), columns_of(RecommendationRow), form)
    else:
        typer.echo(architectures.text(document, line_width()), nl=False)
    if document["blocked"]:
        typer.echo(architectures.explanation(document["blocked"], line_width()), err=True)


def _document(
    asked: Mapping[str, list[str] | float | None],
    sort: Sort,
    limit: int,
    calibrations: int,
    studies: Facts,
) -> Mapping[str, Any]:
    """Answer as GET /v1/recommendations does, without the service: that takes a second to load."""
    given = {name: value for name, value in asked.items() if value not in (None, [])}
    try:
        return ranked(
            {name: sorted(set(v)) if isinstance(v, list) else v for name, v in given.items()},
            measure(),
            sort=sort.value,
            limit=limit,
            calibrations=calibrations,
            facts=studies,
        ).document
    except InvalidValueError as error:
        raise refuse(error.parameter, error.value, error.expected, error.nearest) from error
