"""`sunatlas dataset fetch`: public sets of real readings."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError, given, only_beside

if TYPE_CHECKING:
    from api.real.sets import RealSet


def fetch(
    context: typer.Context,
    name: Annotated[
        str | None, typer.Argument(help="Name of the set; without one they are listed.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Output directory; by default the set's name.")
    ] = None,
    scores: Annotated[
        bool,
        typer.Option(
            "--scores",
            help="Download nothing; print the errors of models on the set, beside those on the "
            "standard data set where models rank most alike.",
        ),
    ] = False,
    form: FormatOption = Format.TABLE,
) -> None:
    """Download real readings from their public source, checked by SHA-256.

    Nothing is bundled: licence and citation are written beside the readings.
    `sunatlas calibrate` reads the files.
    """
    from api.real.fetching import fetch as run  # noqa: PLC0415 - of this command
    from api.real.sets import SETS  # noqa: PLC0415 - as above

    if name is None:
        if options := given(context):
            raise WrongCallError(
                f"{', '.join(options)}: name a set of real readings: {', '.join(SETS)}"
            )
        for one in SETS.values():
            typer.echo(f"{one.name}: {one.about} ({one.licence})")
        return
    if name not in SETS:
        raise WrongCallError(
            f"there is no set of real readings {name!r} (there are {', '.join(SETS)})"
        )
    if scores:
        only_beside(context, "--scores", "--format", "--safe")
        _print_scores(SETS[name], form)
        return
    only_beside(context, "a download", "--out")
    written = run(SETS[name], out or Path(name))
    typer.echo(f"wrote {', '.join(path.name for path in written)} in {out or name}")
    typer.echo(f"cite: {SETS[name].citation}")


def _print_scores(real: RealSet, form: Format) -> None:
    """Print the kept scores of a set, with its licence and whose it is."""
    from api.cli.asking import knowledge  # noqa: PLC0415 - the published record
    from api.real.scores import beside_standard  # noqa: PLC0415 - of this command

    rows = beside_standard(real.name, knowledge().measurements.nominal)
    emit(rows, tuple(rows[0]), form, title=f"{len(rows)} models on {real.name}, runs left out")
    typer.echo(f"licence: {real.licence}", err=True)
    typer.echo(f"cite: {real.citation}", err=True)
