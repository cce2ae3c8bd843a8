"""`python -m tools.faults.load`: a mixed load on the service, for an hour by default.

Exit status 1 for an answer that is 5xx or none, where more than 1 % of the answers took ten
medians or longer, and where memory still rises after ten minutes.
"""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from tools.faults.load.driving import load, names, service
from tools.faults.load.report import failures, report


def main(arguments: list[str] | None = None) -> int:
    """Ask, and print what came of it."""
    parser = argparse.ArgumentParser(prog="python -m tools.faults.load", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--rate", type=float, default=20.0, help="requests a second")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--report", type=Path, help="file that takes the report as well")
    asked = parser.parse_args(arguments)
    with service() as (address, process):
        known = names(address)
        before = os.getloadavg()[0]
        found = load(
            address, process, known, rate=asked.rate, seconds=60 * asked.minutes, seed=asked.seed
        )
    text = report(found)
    busy = f"{before:.1f} at its start and {os.getloadavg()[0]:.1f} at its end"
    text += f"\nThis machine has {os.cpu_count()} processors; its load average was {busy}.\n"
    print(text)
    wrong = failures(found)
    for line in wrong:
        print(line)
    if asked.report:
        asked.report.parent.mkdir(parents=True, exist_ok=True)
        asked.report.write_text("\n".join([text, *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
