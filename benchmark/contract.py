"""What the folders of `benchmark` hand to each other: cells to measure, datasets and their parts.

Protocols say what one folder asks of another: `benchmark.datasets` fulfils them, and a test may
hand in something smaller.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from numpy.typing import NDArray

from algorithms.contract import Floats, Observation, SensorGeometry
from survey_data.nearest import nearest_name

#: Every split of a dataset.
SPLITS = ("calibration", "test", "repeat")

#: In the place of a condition: the first one's readings, calibrated with the directions that drawn
#: benches give, in turn. No preset has a condition of this name.
ON_BENCH = "on-bench"


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


class Samples(Protocol):
    """Observations with their truth."""

    @property
    def observations(self) -> NDArray[Any]:
        """Batch of N in the shape of the preset's kind of observation."""
        ...

    @property
    def sun(self) -> Floats:
        """Unit vectors (N, 3): true ones, in the calibration split its reference's."""
        ...

    @property
    def truth(self) -> Floats:
        """Unit vectors (N, 3): where the Sun or lamp truly stood."""
        ...

    @property
    def origin_px(self) -> NDArray[Any] | None:
        """Detector coordinates (N, 2) of each window's first pixel; None where there are none."""
        ...

    @property
    def context(self) -> Mapping[str, NDArray[Any]] | None:
        """Columns of N rows by name that a preset's `context_columns` says; None for none."""
        ...


class Bound(Protocol):
    """Cramer-Rao bound of the separation angle of N samples."""

    @property
    def angle_deg(self) -> Floats:
        """Standard deviation (N,) in degrees; inf where not observable."""
        ...

    @property
    def unit_angle_deg(self) -> Floats | None:
        """The same with the unit unknown but for flats and darks; None where there is none."""
        ...

    @property
    def observable(self) -> NDArray[Any]:
        """Where (N,) the direction is observable at all."""
        ...


class Repeats(Protocol):
    """How often the poses of the split ``repeat`` are observed."""

    @property
    def passes(self) -> int:
        """Times every pose is observed, pass after pass."""
        ...

    def pose_indices(self, test_samples: int) -> NDArray[Any]:
        """Places (P,) of the poses in a test split of so many samples."""
        ...


class References(Protocol):
    """How many readings of even light and of none a calibration offers."""

    @property
    def darks(self) -> int:
        """Readings without light."""
        ...

    @property
    def flats(self) -> int:
        """Readings of even light."""
        ...


class Observed(Protocol):
    """A condition of a data set, as far as the runner asks."""

    @property
    def sensor(self) -> Any:
        """Its simulated sensor."""
        ...


class Preset(Protocol):
    """A standard dataset."""

    @property
    def name(self) -> str:
        """Unique name."""
        ...

    @property
    def unit(self) -> int:
        """Which unit of its sensor is seen; 0 is the standard one."""
        ...

    @property
    def version(self) -> int:
        """Raised when its data change on purpose."""
        ...

    @property
    def detector(self) -> str:
        """Value of the survey's taxonomy."""
        ...

    @property
    def mask(self) -> str:
        """Value of the survey's taxonomy."""
        ...

    @property
    def observation(self) -> Observation:
        """What an extractor reads here."""
        ...

    @property
    def geometry(self) -> SensorGeometry:
        """Nominal design."""
        ...

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions."""
        ...

    @property
    def context_columns(self) -> tuple[str, ...]:
        """Columns that its samples have beside what the sensor puts out."""
        ...

    @property
    def repeats(self) -> Repeats:
        """Poses and passes of the split ``repeat``."""
        ...

    @property
    def streams(self) -> tuple[str | int, ...]:
        """Names that its random streams begin with."""
        ...

    @property
    def offered(self) -> References:
        """Readings of the unit that methods are given beside a calibration."""
        ...

    def condition(self, name: str) -> Observed:
        """Return a condition; ValueError where there is none of the name."""
        ...

    def geometry_for(self, condition: str) -> SensorGeometry:
        """Return the nominal design under one condition."""
        ...

    def for_unit(self, number: int) -> Preset:
        """Return the dataset as another unit of its sensor sees it; 0 is the standard one."""
        ...

    def generate(self, condition: str, split: str, n: int | None = None) -> Samples:
        """Generate the samples of one split, or the first n of them."""
        ...

    def parameters(self, condition: str) -> Mapping[str, Any]:
        """Everything the numbers depend on."""
        ...

    def bound(self, condition: str, split: str = "test", n: int | None = None) -> Bound:
        """Cramer-Rao bounds of each sample of a split, or of the first n of them."""
        ...

    def references(self, condition: str) -> Mapping[str, NDArray[Any]]:
        """Mean flat and dark readings of the unit that a calibration offers; empty for none."""
        ...

    def reference_error_deg(self, condition: str) -> float:
        """Systematic error of the directions that a calibration is given, root mean square."""
        ...


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
