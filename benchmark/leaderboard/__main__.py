"""Bring a record up to date: `python -m benchmark.leaderboard DIRECTORY WORKERS`.

For processes that measure with other numerical kernels; people call `sunatlas leaderboard update`.
"""

from __future__ import annotations

import sys

from benchmark.leaderboard.update import update
from benchmark.processes import call_to_end


def main() -> int:
    """Bring the record up to date; the process that started this one says how it ended."""
    directory, workers = sys.argv[1:]
    update(directory, int(workers))
    return 0


if __name__ == "__main__":
    call_to_end(main)
