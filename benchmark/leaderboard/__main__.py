"""Bring a record up to date: `python -m benchmark.leaderboard DIRECTORY WORKERS`.

For processes that measure with other numerical kernels; people call `sunatlas leaderboard update`.
"""

from __future__ import annotations

import sys

from benchmark.leaderboard.update import update
from benchmark.running.kernels import INTERRUPTED

if __name__ == "__main__":
    directory, workers = sys.argv[1:]
    try:
        update(directory, int(workers))
    except KeyboardInterrupt:  # the process that started this one says so
        sys.exit(INTERRUPTED)
