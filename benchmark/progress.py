"""Progress of a run: any callable, by default a bar on a terminal and nothing elsewhere.

What takes minutes and is made in one go says a line now and then where there is no terminal
(`console_progress`).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from typing import Protocol

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from benchmark.processes import end_if_requested


class ProgressCallback(Protocol):
    """Called with cells done, cells in all, and what was just finished."""

    def __call__(self, done: int, total: int, what: str, /) -> None:
        """Take in how far something is."""
        ...


def silent(done: int, total: int, what: str) -> None:
    """Show nothing."""


def time_left(elapsed_s: float, done: int, total: int) -> str:
    """Return what time is left in words, "" where that is not known yet."""
    if not 0 < done < total:
        return ""
    left = elapsed_s * (total - done) / done
    return f"{left / 60:.0f} min" if left >= 90.0 else f"{left:.0f} s"


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
        TextColumn("{task.fields[left]}"),
        TextColumn("{task.description}"),
    )
    with Progress(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task("", total=None, left="")

        def report(done: int, total: int, what: str) -> None:
            left = time_left(bar.tasks[task].elapsed or 0.0, done, total)
            said = f"about {left} left" if left else ""
            bar.update(task, completed=done, total=total, description=what, left=said)

        yield report


#: Seconds between two lines where there is no terminal.
PAUSE_S = 15.0


@contextmanager
def console_progress(doing: str, *, quiet: bool = False) -> Iterator[ProgressCallback]:
    """Show a bar on a terminal, a line now and then elsewhere; nothing where `quiet`.

    What it yields also ends what a signal should have ended (`processes.end_if_requested`).
    """
    if quiet:
        shown: AbstractContextManager[ProgressCallback] = nullcontext(silent)
    elif sys.stderr.isatty():
        shown = terminal_progress(doing)
    else:
        shown = nullcontext(lines(doing, lambda line: print(line, file=sys.stderr, flush=True)))  # noqa: T201
    with shown as show:

        def report(done: int, total: int, what: str) -> None:
            end_if_requested()
            show(done, total, what)

        yield report


def lines(
    doing: str,
    say: Callable[[str], object],
    *,
    clock: Callable[[], float] = time.monotonic,
    pause_s: float = PAUSE_S,
) -> ProgressCallback:
    """Return a callback that says how far something is and what time is left, seldom."""
    start = last = clock()

    def report(done: int, total: int, what: str) -> None:
        nonlocal last
        now = clock()
        if now - last < pause_s or not 0 < done < total:
            return
        last = now
        left = time_left(now - start, done, total)
        said = f", about {left} left" if left else ""
        say(f"{doing}: {done} of {total}{said}{f' ({what})' if what else ''}")

    return report
