"""`python -m tools.faults.kills`: kill everything that writes, and let writers meet.

Every program is killed by SIGKILL, SIGTERM and SIGINT at moments drawn by seed, and called again:
the bytes must be those of a run that was left alone, nothing else may lie about, and no worker may
live two seconds after the kill. Pairs of writers that start at once must lose nothing. Exit status
1 where anything is not so. Linux alone: processes are found in /proc.
"""

from __future__ import annotations

import argparse
import random
import shutil
import sys
import tempfile
import time
from pathlib import Path

from tools.faults.kills.commands import COMMANDS, preload
from tools.faults.kills.pairs import PAIRS, PairResult, meet
from tools.faults.kills.report import complaints, report
from tools.faults.kills.trials import Kill, kills


def main(arguments: list[str] | None = None) -> int:
    """Run the campaign and print its tables."""
    parser = argparse.ArgumentParser(prog="python -m tools.faults.kills", description=__doc__)
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", action="append", choices=list(COMMANDS), help="only this program")
    parser.add_argument("--no-pairs", action="store_true", help="leave the pairs out")
    parser.add_argument("--report", type=Path, help="file that takes the report as well")
    asked = parser.parse_args(arguments)
    names = asked.only or list(COMMANDS)
    preload(names)
    started = time.monotonic()
    found, met = [], []
    # No TemporaryDirectory: at the end of a forked child it would take this one's away.
    work = Path(tempfile.mkdtemp(prefix="kills-")).resolve()
    try:
        for one in kills(asked.kills, asked.seed, work, names):
            found.append(one)
            for said in one.wrong:
                print(f"{one.command}, {one.signal} after {one.at_s:.2f} s: {said}", flush=True)
            _keep(asked.report, found, met)  # a campaign that is broken off has found something
        draw = random.Random(asked.seed)
        for number, what in enumerate(() if asked.no_pairs else PAIRS):
            met.append(meet(what, work / f"pair {number}", draw))
            print(what, met[-1].refused, "refused", *met[-1].wrong, flush=True)
    finally:
        shutil.rmtree(work)
    text = report(found, met)
    print(text)
    wrong = complaints(found, met)
    print(*wrong, sep="\n")
    print(f"seed {asked.seed}, {time.monotonic() - started:.0f} s")
    _keep(asked.report, found, met)
    return 1 if wrong else 0


def _keep(path: Path | None, found: list[Kill], met: list[PairResult]) -> None:
    """Write the report of what has been tried so far."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join([report(found, met), *complaints(found, met)]))


if __name__ == "__main__":
    sys.exit(main())
