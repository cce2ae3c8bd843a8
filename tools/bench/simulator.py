"""The simulator, and the centroid of a stack, beside brute force and OpenCV.

``python -m tools.bench.simulator``; exit status 1 when a ratio is above its limit or a subject
does not give its reference's result.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from tools.bench import comparing
from tools.bench.comparing import Subject
from tools.bench.frames import frames_of_a_coded_mask, frames_of_many_spots
from tools.bench.light import diffracted_frames, light_of_frames
from tools.bench.references import centroid_of_spots, rendering_of_frames
from tools.bench.verdicts import Verdict

_REPEATS = 15


def subjects() -> list[Subject]:
    """Prepare everything that is measured; a slower one is repeated as often."""
    prepared = (
        centroid_of_spots,
        rendering_of_frames,
        light_of_frames,
        diffracted_frames,
        frames_of_many_spots,
        frames_of_a_coded_mask,
    )
    return [Subject(**prepare()) for prepare in prepared]


def run() -> list[Verdict]:
    """Measure and print everything; return the verdicts."""
    return comparing.run(subjects(), _REPEATS)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    return comparing.main("tools.bench.simulator", subjects, _REPEATS, arguments)


if __name__ == "__main__":
    sys.exit(main())
