"""What folders of `benchmark` share: splits, cells to measure, the error of a wrong name."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from survey_data.nearest import nearest_name

#: Every split of a dataset.
SPLITS = ("calibration", "test", "repeat")

#: In the place of a condition: the first one's readings, calibrated with the directions that drawn
#: benches give, in turn. No preset has a condition of this name.
ON_BENCH = "on-bench"

#: The condition of a sensor that is calibrated on the ground once, and flown.
FLIGHT = "flight"


@dataclass(frozen=True, order=True)
class Cell:
    """One thing to measure, by names, and by the number of the sensor's unit."""

    dataset: str
    condition: str
    extractor: str
    model: str
    unit: int = 0

    def __str__(self) -> str:
        name = f"{self.dataset}/{self.condition}/{self.extractor}/{self.model}"
        return f"{name}/unit {self.unit}" if self.unit else name


class UnknownNameError(LookupError):
    """A name that is not installed; the message names the nearest that is."""

    def __init__(self, what: str, name: str, known: Iterable[str]) -> None:
        self.what = what
        self.name = name
        self.known = tuple(sorted(known))
        self.nearest = nearest_name(name, self.known)
        known_ones = f"known: {', '.join(self.known)}"
        hint = f"did you mean {self.nearest!r}?" if self.nearest else known_ones
        super().__init__(f"no {what} named {name!r}; {hint}")
