"""The split ``repeat``: poses of the test split, each observed again and again."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmark.simulator.scene import Scene

REPEAT = "repeat"

#: Which samples of a split.
Rows = slice | NDArray[np.int64]


@dataclass(frozen=True)
class Repeats:
    """How many poses are held, and how often each is observed.

    Everything but the noise stays the same between the passes: the spread of the answers to a
    pose is what a data sheet calls repeatability, or noise-equivalent angle.
    """

    poses: int = 25
    passes: int = 8

    def __post_init__(self) -> None:
        if self.poses < 1 or self.passes < 2:
            raise ValueError(
                f"repeats need at least 1 pose and 2 passes; got {self.poses} and {self.passes}"
            )

    def pose_indices(self, test_samples: int) -> NDArray[np.int64]:
        """Places (P,) of the poses in the test split, evenly spread over it."""
        poses = min(self.poses, test_samples)
        return (np.arange(poses) * test_samples + test_samples // 2) // poses

    def scene(self, test: Callable[[Rows], Scene], test_samples: int, n: int | None) -> Scene:
        """Return the first n of the poses' scenes, pass after pass; `test` makes rows of it."""
        poses = self.pose_indices(test_samples)
        again = np.tile(np.arange(len(poses)), self.passes)[:n]
        return test(poses).rows(again)

    def card(self, test_samples: int) -> dict[str, Any]:
        """Size and directions, as cards say it of a split."""
        poses = len(self.pose_indices(test_samples))
        return {
            "samples": poses * self.passes,
            "directions": f"{poses} samples of the test split, evenly spread over it, in "
            f"{self.passes} passes that differ in noise alone",
            "poses": poses,
            "passes": self.passes,
        }


#: For full frames, which are large and whose test split is small.
FEW = Repeats(poses=10, passes=5)
