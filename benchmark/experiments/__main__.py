"""`python -m benchmark.experiments [NAME [CELL ...]]`: measure what is due, or show what is."""

from __future__ import annotations

import argparse
import secrets
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from benchmark.contract import UnknownNameError
from benchmark.processes import call_to_end
from benchmark.results.store import PUBLISHED

if TYPE_CHECKING:
    from benchmark.running.experiment import RecordedExperiment, Report


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure the cells of an experiment that are due, and those only; of every one by default.

    An experiment that keeps nothing is measured whole and printed.
    """
    from benchmark.running.experiment import RecordedExperiment, experiments  # noqa: PLC0415 - slow

    known = experiments()
    parser = argparse.ArgumentParser(
        prog="python -m benchmark.experiments", description=main.__doc__
    )
    parser.add_argument("name", nargs="?", metavar="NAME", help=f"one of {', '.join(known)}")
    parser.add_argument("cells", nargs="*", metavar="CELL", help="only these, due or not")
    parser.add_argument("--check", action="store_true", help="say what is due; exit code 1 if any")
    parser.add_argument("--again", type=int, metavar="K", help="measure K cells anew and compare")
    parser.add_argument("--seed", type=int, help="draws the same K cells; else others")
    parser.add_argument("--all", action="store_true", help="measure every cell, due or not")
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="processes")
    parser.add_argument("--directory", type=Path, default=PUBLISHED, help="of the record")
    options = parser.parse_intermixed_args(arguments)
    if options.workers < 1:
        parser.error(f"--workers must be at least 1; got {options.workers}")
    if options.name is not None and options.name not in known:
        parser.error(str(UnknownNameError("experiment", options.name, known)))
    chosen = known if options.name is None else {options.name: known[options.name]}
    status = 0
    for kind in chosen.values():
        experiment = kind(options.directory)
        try:
            if isinstance(experiment, RecordedExperiment):
                status |= _recorded(experiment, options)
            elif options.name is not None and not options.check:
                status |= _reported(experiment, options)
        except UnknownNameError as error:
            parser.error(str(error))
    return status


def _recorded(experiment: RecordedExperiment[Any], options: argparse.Namespace) -> int:
    from benchmark.running.experiment import list_due, repeat_at_random, update  # noqa: PLC0415 - slow

    if options.check:
        waiting = list_due(experiment)
        for cell, reason in waiting:
            sys.stdout.write(f"{experiment.name} {cell}: {reason}\n")
        return int(bool(waiting))
    if options.again is not None:
        seed = secrets.randbelow(10**6) if options.seed is None else options.seed
        sys.stderr.write(f"{options.again} cells of {experiment.name}, drawn by --seed {seed}\n")
        found = list(repeat_at_random(experiment, options.again, seed, options.workers))
        for cell, text in found:
            sys.stdout.write(f"{experiment.record.name}: {cell}: {text}\n")
        return int(bool(found))
    only = experiment.cells_named(options.cells) if options.cells else None
    done = update(experiment, options.workers, only=experiment.cells() if options.all else only)
    sys.stderr.write(
        f"{experiment.name}: {done.computed} of {done.planned} cells measured in "
        f"{done.seconds:.0f} s\n"
    )
    return 0


def _reported(experiment: Report[Any], options: argparse.Namespace) -> int:
    from benchmark.running.experiment import measure_tasks  # noqa: PLC0415 - slow

    cells = experiment.cells_named(options.cells) if options.cells else experiment.cells()
    found = dict(
        pair for rows in measure_tasks(experiment, cells, options.workers) for pair in rows
    )
    rows = {cell: found[cell] for cell in cells if cell in found}
    for line in experiment.lines(rows):
        sys.stdout.write(f"{line}\n")
    return int(not experiment.passes(rows))


if __name__ == "__main__":
    call_to_end(main)
