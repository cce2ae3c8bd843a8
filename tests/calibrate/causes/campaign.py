"""Draws faults, calibrates, and counts what is called good and errs more than it states.

``python tests/calibrate/causes/campaign.py 20`` draws twenty files of each fault and sensor.
"""

from __future__ import annotations

import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from faults import COUNT, FAULTS, OF_LIGHT, SENSORS, drawn, true_error

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


def main(count: int, first: int, faults: list[str], kinds: list[str]) -> None:
    """Print, of each fault and sensor, how many are good and which of these are false."""
    say = sys.stdout.write
    say(f"{count} files of {COUNT} rows each, seeds {first} to {first + count - 1}\n")
    for fault in faults:
        for kind in kinds:
            if fault in OF_LIGHT and kind == "spot":
                continue
            every = [outcome(kind, fault, seed) for seed in range(first, first + count)]
            good = [one for one in every if one.word == "good"]
            false = [one for one in good if one.false]
            say(f"{fault or 'clean'} {kind}: {len(good)} good, {len(false)} false\n")
            for one in false if fault else [o for o in every if o.word != "good"] + false:
                unseen = " cannot be seen" if one.unseen else ""
                unseen += " said to be hidden" if one.hidden else ""
                say(
                    f"    {one.seed} {one.said}: {one.word} {one.stated_deg:.3g}, true "
                    f"{one.true_deg:.3g}, answered {one.answered:.2f}{unseen}; "
                    f"{one.reason[:160]}; untested: {len(one.untested)}\n"
                )
            sys.stdout.flush()


if __name__ == "__main__":
    wanted = sys.argv[3].split(",") if len(sys.argv) > 3 else ["", *FAULTS]
    kinds = sys.argv[4].split(",") if len(sys.argv) > 4 else list(SENSORS)
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    main(int(sys.argv[1]), first, [f if f != "clean" else "" for f in wanted], kinds)
