"""`python -m tools.mutation`: put small faults into the code, one at a time; do the tests see them?

The faults are Cosmic Ray's, the sample is fixed (`tools.mutation.sample`), the tests are those
named for each module (`tools.mutation.groups`). Exit status 1 below `CAUGHT`, 2 where the tests
fail without any fault.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from cosmic_ray.work_db import WorkDB, use_db

from tools.mutation import running
from tools.mutation.groups import GROUPS
from tools.mutation.report import CAUGHT, accepted_changes, report, score
from tools.mutation.sample import Mutant, draw
from tools.mutation.trying import try_all

ROOT = Path(__file__).parents[2]


def main(arguments: list[str] | None = None) -> int:
    """Try the sample and print the report."""
    asked = _asked(arguments)
    sample = _sample(asked.group or list(GROUPS), asked.module, asked.times)
    if asked.list:
        for name, found in sample.items():
            for one in found:
                print(name, f"{one.module}:{one.start[0]}", one.operator, one.key)
        return 0
    running.prepare()
    with tempfile.TemporaryDirectory(prefix="mutants-") as directory, ExitStack() as stack:
        session = asked.session or Path(directory) / "session.sqlite"
        database = stack.enter_context(use_db(session, WorkDB.Mode.create))
        try:
            tried = try_all(ROOT, sample, Path(directory), asked.workers, database)
        except RuntimeError as error:
            print(error, file=sys.stderr)
            return 2
    text = report(tried, accepted_changes())
    print(text)
    if asked.report:
        asked.report.write_text(text)
    return 0 if score(tried) >= CAUGHT else 1


def _asked(arguments: list[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tools.mutation", description=__doc__)
    parser.add_argument("--group", action="append", choices=list(GROUPS), help="only this group")
    parser.add_argument("--module", action="append", help="only modules whose path has this")
    parser.add_argument("--workers", type=int, default=2, help="mutants tried at a time")
    parser.add_argument("--report", type=Path, help="file that takes the report as well")
    parser.add_argument(
        "--session",
        type=Path,
        help="file (Cosmic Ray's) that keeps what was caught: not tried again by the next run",
    )
    parser.add_argument("--times", type=int, default=1, help="a sample so many times as large")
    parser.add_argument("--list", action="store_true", help="list the sample and try nothing")
    return parser.parse_args(arguments)


def _sample(groups: list[str], parts: list[str] | None, times: int) -> dict[str, list[Mutant]]:
    sample = {}
    for name in groups:
        group = GROUPS[name]
        found = draw(ROOT, group.modules(ROOT), times * group.mutants)
        sample[name] = [
            one for one in found if not parts or any(part in one.module for part in parts)
        ]
    return sample


if __name__ == "__main__":
    sys.exit(main())
