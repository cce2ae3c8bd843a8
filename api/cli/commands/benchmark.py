"""`sunatlas benchmark`: pipelines scored on the standard data sets."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from api.cli.measuring import (
    AVAILABLE_WORKERS,
    ManyWorkersOption,
    SchedulerOption,
    StoreOption,
    say_sources,
    score_cells,
)
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError, only_beside
from api.schema.scores import Score, ScoresQuery
from api.schema.table import columns_of
from benchmark.plan.combinations import Exclusion, cells, list_exclusions

COLUMNS = (
    *("dataset", "condition", "extractor", "model", "rms_deg", "bound_deg", "over_bound"),
    *(
        "bound_unit_deg",
        "over_bound_unit",
        "availability",
        "false_detection_rate",
        "latency_us",
        "status",
    ),
)


@asked_by(ScoresQuery, "dataset", "condition", "extractor", "model")
def benchmark(
    context: typer.Context,
    *,
    asked: Asked,
    data: Annotated[
        Path | None,
        typer.Option(
            help="Score models on this turntable file instead, beside the standard data set "
            "that it behaves like."
        ),
    ] = None,
    config: Annotated[
        Path | None,
        typer.Option(
            help="With --data: meaning of its columns, in the format of `sunatlas calibrate`."
        ),
    ] = None,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    scheduler: SchedulerOption = None,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Score pipelines on the standard data sets.

    Runs every compatible combination of the given data sets, conditions, extractors and models;
    without options, all. Published results are reused if code and data are unchanged. New results
    are kept in the local store (see --store), so that an interrupted run can be continued.
    """
    if data is not None:
        only_beside(context, "--data", "--config", "--model", "--format", "--safe")
        _on_own_data(data, config, list(asked.get("model") or ()) or None, form)
        return
    if config is not None:
        raise WrongCallError("--config belongs to --data FILE, which is not given")
    names = {f"{name}s": given for name, given in asked.items()}
    planned = cells(**names)
    if not planned:
        names.pop("conditions", None)
        refused = list_exclusions(**names)
        typer.echo(f"sunatlas: no compatible combination of these names{_why(refused)}", err=True)
        raise typer.Exit(1)
    result = score_cells(planned, workers, store, scheduler)
    columns = columns_of(Score) if form is Format.CSV else COLUMNS
    document = {"scores": result.rows, "sources": result.sources()}
    emit(result.rows, columns, form, document=document, title=f"{len(result.rows)} scores")
    for warning in result.warnings:
        typer.echo(f"warning: {warning}", err=True)
    say_sources(
        result.published_count, result.stored_count, result.measured_count, result.directory
    )


def _on_own_data(data: Path, config: Path | None, models: list[str] | None, form: Format) -> None:
    """Print every model that applies on a reader's file, beside the standard set most alike."""
    from api.cli.asking import knowledge  # noqa: PLC0415 - the published record
    from calibrate.calibration import calibrate  # noqa: PLC0415 - SciPy
    from calibrate.likeness import alike  # noqa: PLC0415 - as above
    from calibrate.settings import read_settings  # noqa: PLC0415 - as above

    settings = None if config is None else read_settings(config)
    found = calibrate([data], settings, models=models)
    mine = {one.name: one.rms_deg for one in found.candidates if not one.refused}
    ranked = alike(mine, knowledge().measurements.nominal)
    nearest = ranked[0] if ranked else None
    rows = [
        {
            "model": one.name,
            "rms_deg": one.rms_deg if not one.refused else None,
            "standard_error_deg": one.spread_deg if not one.refused else None,
            "dataset": nearest.dataset if nearest else None,
            "dataset_own_error_deg": nearest.errors_deg.get(one.name) if nearest else None,
            "reason": one.refused,
        }
        for one in found.candidates
    ]
    emit(rows, tuple(rows[0]), form, title=f"{len(rows)} models on {data.name}")
    if not ranked:
        typer.echo("fewer than four models answer here and on a standard data set", err=True)
    for one in ranked[:3]:
        typer.echo(
            f"{one.dataset} ({one.detector}, {one.mask}): errors of {len(one.errors_deg)} models "
            f"go with yours within a factor of {one.factor:.2g}",
            err=True,
        )


def _why(refused: Sequence[Exclusion]) -> str:
    """Say why the first combination is none."""
    if not refused:
        return ""
    first = refused[0]
    names = " + ".join(name for name in (first.extractor, first.model) if name)
    return f": {first.dataset}, {names}: {first.reason}"
