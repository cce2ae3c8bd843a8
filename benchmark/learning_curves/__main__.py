"""`python -m benchmark.learning_curves [DIRECTORY] [WORKERS]`: bring the curves up to date."""

from __future__ import annotations

import argparse
import sys

from benchmark.learning_curves.run import update
from benchmark.processes import call_to_end
from benchmark.results.store import PUBLISHED


def main(arguments: list[str] | None = None) -> int:
    """Measure the curves that are missing or of other code, data or leaders, and those only."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmark.learning_curves", description=main.__doc__
    )
    parser.add_argument("directory", nargs="?", default=PUBLISHED, help="of the published record")
    parser.add_argument("workers", nargs="?", type=int, default=1, help="processes")
    options = parser.parse_args(arguments)
    done = update(options.directory, options.workers)
    sys.stderr.write(
        f"{done.computed} of {done.planned} learning curves measured in {done.seconds:.0f} s\n"
    )
    return 0


if __name__ == "__main__":
    call_to_end(main)
