"""Renew the table: `python -m benchmark.error_budget [DATASET ...]`."""

from __future__ import annotations

import argparse
import sys

from benchmark.error_budget import table
from benchmark.leaderboard.scope import compared
from benchmark.plan.parts import installed
from benchmark.processes import call_to_end
from benchmark.progress import terminal_progress
from benchmark.results.store import Store


def main(arguments: list[str] | None = None) -> int:
    """Measure the data sets whose best score has changed, those named, or all."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmark.error_budget", description=main.__doc__
    )
    parser.add_argument("datasets", nargs="*", metavar="DATASET")
    parser.add_argument("--all", action="store_true", help="measure every data set again")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes")
    options = parser.parse_args(arguments)
    if options.workers < 1:
        parser.error(f"--workers must be at least 1; got {options.workers}")
    parts = installed()
    leading = table.leaders(Store().rows(unit=None), compared(parts))
    if unknown := sorted(set(options.datasets) - leading.keys()):
        parser.error(f"no score leads on {', '.join(unknown)}; there are {', '.join(leading)}")
    only = leading.keys() if options.all else options.datasets or None
    with terminal_progress("holding back") as report:
        done = table.renew(leading, parts, only=only, workers=options.workers, progress=report)
    sys.stderr.write(f"{len(done)} of {len(leading)} data sets measured\n")
    return 0


if __name__ == "__main__":
    call_to_end(main)
