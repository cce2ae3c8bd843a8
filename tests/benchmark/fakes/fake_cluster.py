"""Data sets that say which process made them, or end their process."""

from __future__ import annotations

import os
import signal
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fake_atlas
import fake_plan

from benchmark.plan.parts import Parts


@dataclass(frozen=True)
class Watched(fake_atlas.Diodes):
    """Ends its process where the file `deadly` exists."""

    deadly: str = ""

    def generate(self, condition: str, split: str, n: int | None = None) -> Any:
        if self.deadly and Path(self.deadly).exists():
            os.kill(os.getpid(), signal.SIGKILL)
        fake_atlas.log(f"process {os.getpid()} {self.name} {condition} {split}")
        return super().generate(condition, split, n)


def parts(*, deadly: str = "") -> Parts:
    """Three data sets, the third of which may end its process."""
    presets = (
        Watched(name="fake-a", conditions=("quiet",)),
        Watched(name="fake-b"),
        Watched(name="fake-c", deadly=deadly),
    )
    return fake_plan.parts(presets=presets)
