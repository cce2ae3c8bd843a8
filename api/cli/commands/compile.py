"""`sunatlas compile`: compile every kernel now instead of at its first call."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.measuring import WorkersOption
from benchmark.progress import terminal_progress


def compile(  # noqa: A001 - as it is called
    *,
    workers: WorkersOption = 1,
    quiet: Annotated[bool, typer.Option(help="No message at the end.")] = False,
) -> None:
    """Compile all numerical kernels now.

    Compiled kernels are kept beside the source or in the user's cache. The first call in a new
    process is then as fast as later ones.
    """
    from benchmark.running.compiling import compile_kernels  # noqa: PLC0415 - Numba on demand

    with terminal_progress("compiling") as report:
        done = compile_kernels(workers, report)
    if not quiet:
        typer.echo(f"compiled what {done} data sets and extractors call")
