"""`ThermalChamberPreset`: a bench in a thermal chamber, each pose at a temperature of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from benchmark.datasets.conditions.instruments import ABOARD, Instruments
from benchmark.datasets.fields import Split
from benchmark.datasets.parameters import describe
from benchmark.datasets.preset import Preset, drawn_split
from benchmark.datasets.repeats import REPEAT, Rows
from benchmark.datasets.samples import Samples
from benchmark.seeds import generator
from benchmark.simulator.flight.time_series import TimedScene
from benchmark.simulator.scene import Scene

_ZERO_C_IN_K = 273.15
#: The one column of the samples' context.
_COLUMN = "temperature_K"


@dataclass(frozen=True)
class Chamber:
    """Temperatures of the poses, uniform between two limits, deg C.

    Attributes
    ----------
    calibrated_c, tested_c
        Lowest and highest of the calibration and of the test split.
    thermometer
        Its errors are those of the instruments' thermometer.
    """

    calibrated_c: tuple[float, float]
    tested_c: tuple[float, float]
    thermometer: Instruments = ABOARD

    def __post_init__(self) -> None:
        for name in ("calibrated_c", "tested_c"):
            low, high = getattr(self, name)
            if not -_ZERO_C_IN_K < low <= high:
                raise ValueError(
                    f"{name} must be two temperatures in order, above {-_ZERO_C_IN_K} deg C; got "
                    f"{low} and {high}"
                )

    def draw_k(self, split: Split, count: int, *names: str | int) -> Floats:
        """(N,) kelvin of a split's poses."""
        low, high = self.calibrated_c if split == "calibration" else self.tested_c
        drawn = generator(*names, split, "chamber").random(count)
        return np.asarray(_ZERO_C_IN_K + low + (high - low) * drawn)


@dataclass(frozen=True)
class ThermalChamberPreset(Preset):
    """A dataset whose sensors drift with temperature, on a bench in a thermal chamber.

    Samples carry the context column ``temperature_K``, as a thermometer reads it. Nothing ages.

    Attributes
    ----------
    chambers
        Temperatures by condition; every condition has one.
    drawn
        Facts of its drawing beyond the geometry, named as in `registry.fidelity.evidence`.
    """

    chambers: Mapping[str, Chamber] = field(default_factory=dict)
    drawn: Mapping[str, float | str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, setup in self.setups.items():
            if name not in self.chambers:
                raise ValueError(f"condition {name} has no temperatures in `chambers`")
            if not hasattr(setup.sensor, "thermal"):
                raise TypeError(
                    f"the sensor of condition {name} must drift with temperature; got "
                    f"{type(setup.sensor).__name__}"
                )

    @classmethod
    def of(
        cls,
        ground: Preset,
        chambers: Mapping[str, Chamber],
        drawn: Mapping[str, float | str] = MappingProxyType({}),
    ) -> ThermalChamberPreset:
        """Return a dataset on the ground, taken in a chamber."""
        same = {part.name: getattr(ground, part.name) for part in fields(Preset)}
        return cls(**same, chambers=chambers, drawn=drawn)

    @property
    def context_columns(self) -> tuple[str, ...]:
        """The thermometer's column."""
        return (_COLUMN,)

    def parameters(self, condition: str) -> dict[str, Any]:
        """As `Preset.parameters`, with the temperatures."""
        chamber = describe(self.chambers[condition])
        return {**super().parameters(condition), "chamber": chamber}

    def _scene(self, condition: str, known: Split, rows: Rows = slice(None)) -> TimedScene:
        scene = super()._scene(condition, known, rows)
        warm = self._temperature_k(condition, known)[rows]
        same = {part.name: getattr(scene, part.name) for part in fields(Scene)}
        return TimedScene(**same, temperature_k=warm, age_years=np.zeros(len(warm)))

    def _temperature_k(self, condition: str, known: Split) -> Floats:
        count = int(self.directions.card()[known]["samples"])
        return self.chambers[condition].draw_k(known, count, *self.streams, condition)

    def context(self, condition: str, split: str) -> dict[str, NDArray[Any]]:
        """Return what the thermometer reads of each sample."""
        if split == REPEAT:
            test = self.context(condition, "test")
            again = np.tile(self.repeats.pose_indices(self._tested), self.repeats.passes)
            return {name: column[again] for name, column in test.items()}
        known = drawn_split(split)
        noise = self._of_unit(*self.streams, condition, known)
        thermometer = self.chambers[condition].thermometer
        truth = self._temperature_k(condition, known)
        return {_COLUMN: thermometer.thermometer_k(truth, self._bench_names, noise)}

    def generate(self, condition: str, split: str, n: int | None = None) -> Samples:
        """As `Preset.generate`, with the context's column."""
        plain = super().generate(condition, split, n)
        context = self.context(condition, split)
        return replace(plain, context={name: column[:n] for name, column in context.items()})

    def card(self) -> dict[str, Any]:
        """As `Preset.card`, with the context's column."""
        said = "(N,) of the sensor, as a thermometer with the chamber's errors reads it"
        return {**super().card(), "context": {_COLUMN: said}}
