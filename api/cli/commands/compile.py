"""`sunatlas compile`: compile every kernel now instead of at its first call."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.measuring import WorkersOption
from benchmark.progress import terminal_progress

app = typer.Typer(add_completion=False, rich_markup_mode=None)


@app.command("compile")
def compile_command(
    *,
    workers: WorkersOption = 1,
    quiet: Annotated[bool, typer.Option(help="Say nothing when done.")] = False,
) -> None:
    """Compile every kernel now instead of at its first call.

    Numerical kernels are compiled at their first call and kept on disk, beside the source or in
    the user's cache directory. Afterwards the first extraction and the first frame in any new
    process take no longer than the later ones. What is compiled already is left as it is.
    """
    from benchmark.running.compiling import compile_kernels  # noqa: PLC0415 - Numba on demand

    with terminal_progress("compiling") as report:
        done = compile_kernels(workers, report)
    if not quiet:
        typer.echo(f"compiled what {done} data sets and extractors call")
