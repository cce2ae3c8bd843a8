"""Data sets that say which process made them, wait at a gate, or end their process."""

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
    """Opens the pipe `gate` for reading, which waits for who writes; dies where `deadly` exists."""

    gate: str = ""
    deadly: str = ""

    def generate(self, condition: str, split: str, n: int | None = None) -> Any:
        if self.gate:
            os.close(os.open(self.gate, os.O_RDONLY))
        if self.deadly and Path(self.deadly).exists():
            os.kill(os.getpid(), signal.SIGKILL)
        fake_atlas.log(f"process {os.getpid()} {self.name} {condition} {split}")
        return super().generate(condition, split, n)


def parts(*, gate: str = "", deadly: str = "") -> Parts:
    """Three data sets: six bundles for two workers; the gate stands before all but the first."""
    presets = (
        Watched(name="fake-a", conditions=("quiet",)),
        Watched(name="fake-b", gate=gate),
        Watched(name="fake-c", gate=gate, deadly=deadly),
    )
    return fake_plan.parts(presets=presets)
