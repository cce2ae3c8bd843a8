"""`sunatlas compare`: architectures side by side, or masks at equal height, detector and field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

import typer

from api.cli.asking import ask
from api.cli.measuring import AVAILABLE_WORKERS, ManyWorkersOption
from api.cli.options import Asked, asked_by
from api.cli.table_output import Format, FormatOption, emit_answer, say
from api.cli.wrong_call import WrongCallError
from api.schema.comparison import CompareQuery
from api.service.comparing import compare as compared
from api.service.comparing import equal_document, equal_heights
from api.service.documents import Document

#: What a terminal shows; JSON has everything.
_SHOWN = (
    *("detector", "mask", "dataset", "extractor", "model", "own_error_deg", "height_mm"),
    *("own_at_1_mm_deg", "bound_deg", "half_fov_deg"),
)
_EQUAL = ("design", "pipeline", "flight", "low", "high", "own", "bound")


@asked_by(CompareQuery, "architecture", "dataset", "pipeline", "condition")
def compare(
    *,
    asked: Asked,
    equal: Annotated[
        bool, typer.Option("--equal", help="Masks at equal height, detector and field.")
    ] = False,
    height: Annotated[
        float | None, typer.Option(help="Height in mm; measured now.", show_default="0.5")
    ] = None,
    field: Annotated[
        float | None,
        typer.Option(help="Full field of view in deg; measured now.", show_default="120"),
    ] = None,
    units: Annotated[
        int | None, typer.Option(min=1, help="Sensor units; measured now.", show_default="9")
    ] = None,
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    form: FormatOption = Format.TABLE,
) -> None:
    """Compare architectures, or masks at equal height.

    Or pipelines of a data set. With --equal: the masks that fit over the same CMOS array, at the
    same height and over the same field. The best pipeline of each is chosen on one sensor unit and
    quoted on others. Published values, unless --height, --field or --units ask for others, which
    takes minutes.
    """
    changed = any(value is not None for value in (height, field, units))
    if not equal:
        if changed:
            raise WrongCallError("--height, --field and --units need --equal")
        emit_answer(ask(compared, asked), form, _SHOWN)
        return
    if asked:
        raise WrongCallError("--equal takes no architectures, data set or pipelines")
    answer = _measured(height, field, units, workers) if changed else ask(equal_heights)
    rows = answer.rows()
    measured = [_cells(row) for row in rows if row["flight_error_deg"] is not None]
    emit_answer(answer, form, _EQUAL, rows=measured)
    if form is Format.TABLE:
        _explain(answer)


def _explain(answer: Document) -> None:
    """Say why some masks have no error, and what all have in common."""
    rows = answer.rows()
    for row in rows:
        if row["flight_error_deg"] is None:
            say(f"{row['design']}: {row['reason'] or 'below 95 % availability in flight'}")
        elif row["flight_low_deg"] is None:
            say(f"{row['design']}: in flight without its units below 95 % availability")
    for row in rows[:1]:
        say(
            f"Errors in deg. {answer.document['detector']}; height {row['height_mm']:g} mm, field "
            f"{2 * row['half_fov_deg']:g} deg, {row['units']} units."
        )


def _cells(row: Mapping[str, Any]) -> dict[str, Any]:
    errors = {
        "flight": row["flight_error_deg"],
        "low": row["flight_low_deg"],
        "high": row["flight_high_deg"],
        "own": row["own_error_deg"],
        "bound": row["bound_deg"],
    }
    return {
        "design": row["design"],
        "pipeline": f"{row['extractor']} + {row['model']}",
        **{n: None if error is None else float(f"{error:.2g}") for n, error in errors.items()},
    }


def _measured(
    height: float | None, field: float | None, units: int | None, workers: int
) -> Document:
    from benchmark.equal_height import designs  # noqa: PLC0415 - loads the simulator
    from benchmark.equal_height.measure import UNITS  # noqa: PLC0415
    from benchmark.equal_height.record import by_flight  # noqa: PLC0415
    from benchmark.experiments.equal_height import EqualHeight  # noqa: PLC0415
    from benchmark.running.experiment import measure_tasks  # noqa: PLC0415

    half = designs.HALF_FOV_DEG if field is None else field / 2.0
    try:
        place = designs.Place(designs.HEIGHT_MM if height is None else height, half)
    except designs.UnfitError as error:
        raise WrongCallError(f"--height, --field: {error}") from error
    experiment = EqualHeight(place=place, units=UNITS if units is None else units)
    done = measure_tasks(experiment, experiment.cells(), workers)
    return equal_document(by_flight([row for rows in done for _, row in rows]))
