"""`sunatlas deposit`: the bundle an archive takes."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from api.cli.tables import Format, FormatOption, emit
from api.deposit import bundle as deposit

app = typer.Typer(
    help="Build or verify the bundle an archive takes.", add_completion=False, rich_markup_mode=None
)


@app.command()
def build(
    *,
    out: Annotated[
        Path, typer.Option(help="Directory to make; an earlier bundle there is replaced.")
    ] = Path("out/deposit"),
    form: FormatOption = Format.TABLE,
) -> None:
    """Build the bundle: the survey's tables and the published results, ready for an archive.

    A Data Package with RO-Crate metadata, licences, CITATION.cff and checksums, as a directory
    and as a zip beside it. The same sources give the same bytes.
    """
    bundle = deposit.build(out)
    rows = [
        {"file": name, "bytes": (bundle.directory / name).stat().st_size} for name in bundle.files
    ]
    document = {
        "directory": str(bundle.directory),
        "archive": str(bundle.archive),
        "files": rows,
    }
    emit(rows, ("file", "bytes"), form, document=document, title=str(bundle.directory))
    typer.echo(f"built {bundle.directory} and {bundle.archive}", err=True)


@app.command()
def verify(
    directory: Annotated[Path, typer.Argument(help="Directory of the bundle.", show_default=False)],
    form: FormatOption = Format.TABLE,
) -> None:
    """Verify a bundle: every checksum, then every table against its description.

    What does not hold is listed with its file, and the exit code is 1.
    """
    wrong = deposit.verify(directory)
    rows = [{"file": name, "problem": problem} for name, problem in wrong]
    if rows or form is not Format.TABLE:
        emit(rows, ("file", "problem"), form, title=f"{directory}: {len(rows)} problems")
    if rows:
        raise typer.Exit(1)
    typer.echo(f"{directory}: every checksum and every table holds", err=True)
