"""Progress of a run: any callable, by default a bar on a terminal and nothing elsewhere."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

ProgressCallback = Callable[[int, int, str], None]
"""Called with cells done, cells in all, and what was just finished."""


def silent(done: int, total: int, what: str) -> None:
    """Show nothing."""


@contextmanager
def terminal_progress(doing: str = "measuring") -> Iterator[ProgressCallback]:
    """Show a bar on standard error when that is a terminal; silence otherwise."""
    if not sys.stderr.isatty():
        yield silent
        return

    columns = (
        TextColumn(doing),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=None)

        def report(done: int, total: int, what: str) -> None:
            bar.update(task, completed=done, total=total, description=what)

        yield report
