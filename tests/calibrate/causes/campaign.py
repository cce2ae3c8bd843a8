"""Draws a fault, calibrates, and says whether the file is called good and how it errs in flight."""

from __future__ import annotations

import re
import tempfile
from dataclasses import dataclass
from pathlib import Path

from faults import SENSORS, drawn, true_error

from algorithms.contract import UnusableDataError
from calibrate.calibration import calibrate
from calibrate.table import TableError

#: Faults of the level without light, which the sensor's own stray light adds to.
_OF_LEVEL = ("dark", "inverted")
#: True error over the stated from which "good" is false.
FALSE = 1.5


@dataclass(frozen=True)
class Outcome:
    """What a calibration said of a file and how it errs in flight."""

    kind: str
    fault: str
    seed: int
    said: str
    word: str
    reason: str
    stated_deg: float = float("nan")
    true_deg: float = float("nan")
    answered: float = float("nan")
    unseen: bool = False
    untested: tuple[str, ...] = ()
    half: float = 0.0

    @property
    def hidden(self) -> bool:
        """Whether the report says that a fault as large as this one is not seen."""
        half = [re.search(r"one half of an axis.* up to ([\d.]+) %", one) for one in self.untested]
        stray = [re.search(r"stray light.* from ([\d.e-]+) of it on", o) for o in self.untested]
        return any(one and 0.0 < 100.0 * self.half <= float(one[1]) for one in half) or any(
            one and self.fault in _OF_LEVEL and SENSORS[self.kind].stray >= float(one[1])
            for one in stray
        )

    @property
    def false(self) -> bool:
        """Whether it is called good and errs more than 1.5 times the stated error."""
        return self.word == "good" and self.true_deg > FALSE * self.stated_deg


def outcome(kind: str, fault: str, seed: int) -> Outcome:
    """Calibrate one drawn file; conventions are applied for every other seed."""
    with tempfile.TemporaryDirectory() as directory:
        made = drawn(Path(directory), kind, fault, seed)
        try:
            found = calibrate([made.path], models=SENSORS[kind].models, apply=seed % 2 == 0)
        except (UnusableDataError, TableError) as error:
            return Outcome(kind, fault, seed, made.said, "refused", str(error))
        true, answered = true_error(found, kind, made, seed)
    verdict = found.verdict
    return Outcome(
        kind, fault, seed, made.said, verdict.word, verdict.reason, found.chosen.rms_deg, true,
        answered, made.unseen, verdict.untested, made.half,
    )  # fmt: skip
