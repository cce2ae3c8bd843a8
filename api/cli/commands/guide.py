"""`sunatlas guide`: the site that the service has at /guide."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from benchmark.progress import console_progress

app = typer.Typer(no_args_is_help=True, add_completion=False, rich_markup_mode=None)


@app.callback()
def guide() -> None:
    """Build the guide, served at /guide."""


@app.command()
def build(
    out: Annotated[
        Path | None, typer.Option(help="Output directory; an earlier guide is replaced.")
    ] = None,
    *,
    strict: Annotated[
        bool, typer.Option("--strict", help="Exit with code 1 on a warning.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Show warnings only.")] = False,
) -> None:
    """Build the guide from the pages of docs/.

    Without --out the guide is written to the user's cache, where `sunatlas serve` finds it; an
    up-to-date guide is not built again. No network is needed. Requires the extra `guide`.
    """
    from api.guide import site  # noqa: PLC0415 - reads all pages

    with console_progress("building the guide", quiet=quiet) as progress:
        warnings = site.keep(progress) if out is None else site.build(out, progress)
    for warning in warnings:
        typer.echo(warning, err=True)
    if not quiet:
        typer.echo(f"{site.cached_site() if out is None else out}: {len(warnings)} warnings")
    if strict and warnings:
        raise typer.Exit(1)
