"""Standard datasets: `names`, `get`; and sensors of single studies: `study_names`.

A dataset is one module of `benchmark.datasets.standard` or `benchmark.datasets.studies` that
defines ``PRESET``; nothing else registers it.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from types import ModuleType

from benchmark.datasets import standard, studies
from benchmark.datasets.calibration import SHOWN_IDEAL
from benchmark.datasets.card import parameters_of
from benchmark.datasets.conditions.mission import with_flight
from benchmark.datasets.preset import Condition, Preset
from benchmark.datasets.samples import Samples, samples_hash
from survey_data.nearest import nearest_name

__all__ = [
    "Condition",
    "Preset",
    "Samples",
    "UnknownDatasetError",
    "get",
    "names",
    "parameters_of",
    "samples_hash",
    "study_names",
]


class UnknownDatasetError(LookupError, ValueError):
    """No dataset has this name; `nearest` is the closest one, or None."""

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        self.name = name
        self.nearest = nearest_name(name, known)
        hint = f"; did you mean {self.nearest!r}?" if self.nearest else ""
        super().__init__(f"no dataset {name!r}{hint}; there are {', '.join(known)}")


def names() -> tuple[str, ...]:
    """Names of all standard datasets, sorted."""
    return tuple(sorted(_presets()))


def study_names() -> tuple[str, ...]:
    """Names of the sensors of single studies, sorted.

    Only the pipelines of the studies that such a dataset follows are scored on it.
    """
    return tuple(sorted(_of_studies()))


def get(name: str) -> Preset:
    """Return the dataset of this name, a standard one or the sensor of a study.

    UnknownDatasetError names the nearest known one.
    """
    presets = {**_presets(), **_of_studies()}
    if name not in presets:
        raise UnknownDatasetError(name, tuple(sorted(presets)))
    return presets[name]


@cache
def _presets() -> dict[str, Preset]:
    return {
        name: with_flight(preset.with_ideal_calibration() if name in SHOWN_IDEAL else preset)
        for name, preset in _found_in(standard).items()
    }


@cache
def _of_studies() -> dict[str, Preset]:
    return _found_in(studies)


def _found_in(package: ModuleType) -> dict[str, Preset]:
    found: dict[str, Preset] = {}
    for module in pkgutil.iter_modules(package.__path__):
        loaded = importlib.import_module(f"{package.__name__}.{module.name}")
        preset = getattr(loaded, "PRESET", None)
        if not isinstance(preset, Preset):
            raise TypeError(f"{loaded.__name__} must define PRESET, a Preset; got {preset!r}")
        if preset.name in found:
            raise ValueError(f"two datasets are called {preset.name!r}")
        if preset.name.replace("-", "_") != module.name:
            raise ValueError(
                f"dataset {preset.name!r} belongs in a module called "
                f"{preset.name.replace('-', '_')}; it is in {module.name}"
            )
        found[preset.name] = preset
    return found
