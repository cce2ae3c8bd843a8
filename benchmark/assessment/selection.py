"""Settings that models choose from their calibration beside the best fixed ones in hindsight.

``python -m benchmark.experiments selection [dataset ...]``. Of every data set at nominal and every
model that chooses settings and fits it: the error of the test split with the settings chosen, over
the smallest of all fixed ones. A choice that sees the calibration alone cannot always be the best;
it should not be far off.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from algorithms.angles import separation_deg
from algorithms.calibration.calibrated import CalibratedModel
from algorithms.calibration.quality import Setting
from algorithms.contract import Extractor, Floats, UnusableDataError
from algorithms.models.lut.blended_polynomials import DEGREES
from algorithms.models.lut.error_tables import SMOOTHINGS
from algorithms.models.non_physical.fourier_balance import MAX_HARMONICS
from algorithms.models.non_physical.polynomial import MAX_DEGREE
from algorithms.models.non_physical.signal_polynomial import MAX_DEGREE as MAX_SIGNAL_DEGREE
from benchmark.contract import Cell, Preset
from benchmark.datasets.corrected import correction
from benchmark.datasets.features import features_of
from benchmark.plan.combinations import cells
from benchmark.plan.parts import installed_parts

WORST = 1.1
"""Error with chosen settings over that of the best fixed ones, which a choice should keep to."""

NOMINAL = "nominal"
#: Samples of the calibration that an extractor must find something in.
_FOUND = 0.9

_DEGREES = tuple({"degree": degree} for degree in range(1, MAX_DEGREE + 1))

SETTINGS: Mapping[str, tuple[Mapping[str, float], ...]] = {
    "fourier-balance": tuple({"harmonics": n} for n in range(1, MAX_HARMONICS + 1)),
    "lut": tuple({"smoothing": weight} for weight in SMOOTHINGS),
    "lut-polynomial": tuple(
        {"degree": degree, "smoothing": weight} for degree in DEGREES for weight in SMOOTHINGS
    ),
    "polynomial-1d": _DEGREES,
    "polynomial-2d": _DEGREES,
    "polynomial-signals": tuple({"degree": n} for n in range(1, MAX_SIGNAL_DEGREE + 1)),
}
"""Every fixed setting of each model that chooses."""


@dataclass(frozen=True)
class Choice:
    """A model's choice on one data set.

    Attributes
    ----------
    dataset, extractor, model : str
        Of what.
    chosen, best : mapping
        Settings that it chose, and those with the smallest error on the test split.
    chosen_deg, best_deg : float
        Root mean square errors with them, over samples that all settings answer.
    """

    dataset: str
    extractor: str
    model: str
    chosen: Mapping[str, Setting]
    best: Mapping[str, float]
    chosen_deg: float
    best_deg: float

    @property
    def ratio(self) -> float:
        """Error with the chosen settings over that with the best ones."""
        return self.chosen_deg / self.best_deg


@dataclass(frozen=True)
class SelectionData:
    """Features (n, F) of corrected readings and true Suns (n, 3) of both splits."""

    features: Floats
    sun: Floats
    asked: Floats
    true: Floats


def choices(datasets: Sequence[str] | None = None) -> Iterator[Choice]:
    """Give the choice of every model on every data set named (None: all), in sorted order."""
    parts = installed_parts()
    planned: dict[tuple[str, str], list[Cell]] = {}
    for cell in cells(datasets, NOMINAL, None, list(SETTINGS)):
        planned.setdefault((cell.dataset, cell.model), []).append(cell)
    seen: dict[tuple[str, str], SelectionData | None] = {}
    for (dataset, model), suiting in planned.items():
        preset = parts.preset(dataset)
        for cell in suiting:
            place = dataset, cell.extractor
            if place not in seen:
                seen[place] = selection_data(preset, parts.extractor(cell.extractor))
            calibration = seen[place]
            if calibration is None:
                continue
            extractor = parts.extractor(cell.extractor)
            made = parts.model(model).for_sensor(preset.geometry, extractor.about.kind)
            if not isinstance(made, CalibratedModel):
                continue
            found = chosen_and_best(made, SETTINGS[model], calibration)
            if found is not None:
                yield Choice(dataset, cell.extractor, model, *found)
                break


def selection_data(preset: Preset, extractor: type[Extractor]) -> SelectionData | None:
    """Return what an extractor finds at nominal; None where that is too little to compare."""
    made = extractor.for_sensor(preset.geometry)
    splits = [preset.generate(NOMINAL, split) for split in ("calibration", "test")]
    by = correction(preset, NOMINAL)
    calibration, asked = (features_of(made, split, by) for split in splits)
    if np.isfinite(calibration).all(axis=1).mean() < _FOUND:
        return None
    return SelectionData(calibration, splits[0].truth, asked, splits[1].truth)


def chosen_and_best(
    model: CalibratedModel, settings: Sequence[Mapping[str, float]], calibration: SelectionData
) -> tuple[Mapping[str, Setting], Mapping[str, float], float, float] | None:
    """Chosen settings, the best of `settings`, and their errors; None where the choice is refused.

    Fixed settings that the samples do not settle are left out.
    """
    try:
        fitted = model.fit(calibration.features, calibration.sun)
    except UnusableDataError:
        return None
    chosen = dict(fitted.quality_.settings)
    tried, answers = [], [fitted.predict(calibration.asked)]
    for fixed in settings:
        try:
            given: dict[str, Any] = dict(fixed)
            other = replace(model, **given).fit(calibration.features, calibration.sun)
        except UnusableDataError:
            continue
        tried.append(fixed)
        answers.append(other.predict(calibration.asked))
    if not tried:
        return None
    errors = np.stack([separation_deg(answer, calibration.true) for answer in answers])
    both = np.isfinite(errors).all(axis=0)
    sizes = np.sqrt(np.mean(errors[:, both] ** 2, axis=1))
    best = int(np.argmin(sizes[1:]))
    return chosen, tried[best], float(sizes[0]), float(sizes[1 + best])
