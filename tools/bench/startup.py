"""What `sunatlas --help` costs, beside importing Typer: ``python -m tools.bench.startup``.

Processor time of a process each, not time that passes.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from tools.bench import comparing
from tools.bench.comparing import Subject
from tools.bench.verdicts import Verdict

_ROOT = Path(__file__).parents[2]
_LIMIT = 2.5
_REPEATS = 5


def _process(*arguments: str) -> Callable[[], object]:
    command = [sys.executable, *arguments]
    return lambda: subprocess.run(command, cwd=_ROOT, stdout=subprocess.DEVNULL, check=True)


def spent_by_processes() -> float:
    """Return the processor time of the processes that this one started and that have ended, s."""
    import resource  # not on Windows, where the other harnesses run

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def subjects() -> list[Subject]:
    """Prepare the pair."""
    return [
        Subject(
            name="sunatlas --help",
            reference_name="import typer",
            call=_process("-m", "api.cli.command_line", "--help"),
            reference=_process("-c", "import typer"),
            items=1,
            reference_items=1,
            limit=_LIMIT,
            clock=spent_by_processes,
        )
    ]


def run() -> list[Verdict]:
    """Measure and print; return the verdicts."""
    return comparing.run(subjects(), _REPEATS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    return comparing.main("tools.bench.startup", subjects, _REPEATS, arguments)


if __name__ == "__main__":
    sys.exit(main())
