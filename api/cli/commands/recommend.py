"""`sunatlas recommend`: ranked ways from a task to a calibrated sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from api.cli import attributes
from api.cli.asking import ask
from api.cli.tables import Format, FormatOption, emit
from api.http.routers.recommendations import recommendations

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = (
    *("rank", "task", "detector", "mask", "model", "extractor"),
    *("studies", "support", "rms_deg", "over_bound", "pareto"),
)
CSV_COLUMNS = (
    *COLUMNS,
    *("keys", "measured_dataset", "measured_condition", "measured_extractor", "measured_model"),
    *("bound_deg", "half_fov_deg", "latency_us"),
)


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
    max_error_deg: Annotated[float | None, typer.Option(help="Largest error, degrees.")] = None,
    min_fov_deg: Annotated[
        float | None, typer.Option(help="Smallest full field of view, degrees.")
    ] = None,
    max_latency_us: Annotated[
        float | None, typer.Option(help="Longest time a sample, microseconds.")
    ] = None,
    condition: Annotated[
        str | None, typer.Option(help="Condition of the measured columns; nominal by default.")
    ] = None,
    limit: Annotated[int, typer.Option(min=1, max=500, help="Paths to print at most.")] = 20,
    form: FormatOption = Format.TABLE,
) -> None:
    """Rank the sensors and calibrations that meet requirements.

    Literature and measurement stay apart: how many studies took a path, and what its best
    pipeline achieved on our data. Paths that no other beats in both are marked pareto. Where
    nothing is left, the requirement that rules everything out is named, exit code 0.
    """
    document = ask(
        recommendations,
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
            "max_latency_us": max_latency_us,
            "condition": condition,
            "limit": limit,
        },
    ).document
    paths = document["paths"]
    title = f"{len(paths)} of {document['count']} paths"
    columns = CSV_COLUMNS if form is Format.CSV else COLUMNS
    emit([_row(path) for path in paths], columns, form, document=document, title=title)
    if document["blocked"] and form is not Format.JSON:
        _explain(document["blocked"])


def _row(path: Mapping[str, Any]) -> dict[str, Any]:
    measured = path["measured"] or {}
    named = ("dataset", "condition", "extractor", "model")
    return {
        **{name: path[name] for name in ("rank", "task", "detector", "mask", "model", "extractor")},
        "studies": path["literature"]["studies"],
        "support": path["literature"]["support"],
        **{name: measured.get(name) for name in ("rms_deg", "over_bound", "bound_deg")},
        **{name: measured.get(name) for name in ("half_fov_deg", "latency_us")},
        **{f"measured_{name}": measured.get(name) for name in named},
        "pareto": path["pareto"],
        "keys": path["studies"],
    }


def _explain(blocked: Mapping[str, Any]) -> None:
    typer.echo(f"nothing is left: {blocked['constraint']}: {blocked['detail']}", err=True)
    for relaxation in blocked["relaxations"]:
        others = {k: v for k, v in relaxation.items() if k not in {"constraint", "paths"}}
        change = ", ".join(f"{name} {value}" for name, value in others.items())
        typer.echo(
            f"  {relaxation['constraint']}: {change or 'drop'}: {relaxation['paths']} paths",
            err=True,
        )
