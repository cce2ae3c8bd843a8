"""What stages hand on: tasks, data, answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from algorithms.chain import Scored
from algorithms.contract import Extractor, Floats
from algorithms.references import ReferenceCorrection
from benchmark.datasets.pins import Pin

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset
    from benchmark.datasets.samples import Samples
    from benchmark.metrics.bounds import Bound


#: By split; None where a sensor has no references.
Corrections = Mapping[str, ReferenceCorrection | None]


@dataclass(frozen=True)
class Task:
    """One dataset, condition, unit and extractor with the models to score behind it.

    The preset is of unit 0. `all_observable`: the direction is known to be observable from every
    test sample, so that another unit than the standard one needs no bound.
    """

    preset: Preset
    condition: str
    extractor: type[Extractor]
    models: tuple[Scored, ...]
    unit: int = 0
    all_observable: bool = False


@dataclass(frozen=True)
class ConditionData:
    """Samples of every split of a data set under one condition, and what bounds them.

    Attributes
    ----------
    preset
        Of unit 0.
    splits
        Samples by split; another unit than the standard one has no split ``repeat``. They are
        corrected by the unit's references already where there are no `corrections`. Without
        observations where only directions and bounds were asked for (`truth`).
    bound_deg, bound_unit_deg
        Cramer-Rao bounds (N,) of the test split, with the unit known and unknown; None for another
        unit, and the second where there is none.
    observable
        Test samples (N,) whose direction is observable.
    pins
        Of the standard unit, of the data before correction; none for another.
    bound
        As a whole, of the standard unit; None for another.
    corrections
        By split, by the unit's references, of samples that would take too much memory corrected.
    features
        What extractors found, by their classes and splits: for who asks for the same again.
    """

    preset: Preset
    splits: dict[str, Samples]
    bound_deg: Floats | None
    bound_unit_deg: Floats | None
    observable: NDArray[np.bool_]
    pins: tuple[Pin, ...]
    bound: Bound | None = None
    corrections: Corrections = field(default_factory=dict)
    features: dict[tuple[type[Extractor], str], Floats] = field(default_factory=dict)


@dataclass(frozen=True)
class RenderedData:
    """Data as the sensor reads them, and how each split is to be corrected."""

    data: ConditionData
    corrections: Corrections


@dataclass(frozen=True)
class Answers:
    """What a fitted pipeline answers, before it is judged.

    Attributes
    ----------
    test
        Directions (N, 3) of the test split: of one fit to true directions, or of one to those of
        each drawn bench.
    repeat
        Of the split ``repeat``, or None.
    found
        Where (N,) the extractor gave features of the test split.
    refused
        Why the model refused its calibration, and there are no answers; empty where it did not.
    """

    test: tuple[Floats, ...] = ()
    repeat: Floats | None = None
    found: NDArray[np.bool_] | None = None
    refused: str = ""
