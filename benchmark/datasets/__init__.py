"""Standard datasets: `names`, `get`.

A dataset is one module of `benchmark.datasets.standard` that defines ``PRESET``; nothing else
registers it.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from benchmark.datasets import standard
from benchmark.datasets.calibration import SHOWN_IDEAL
from benchmark.datasets.card import parameters_of
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
]


class UnknownDatasetError(LookupError, ValueError):
    """No dataset has this name; `nearest` is the closest one, or None."""

    def __init__(self, name: str, known: tuple[str, ...]) -> None:
        self.name = name
        self.nearest = nearest_name(name, known)
        hint = f"; did you mean {self.nearest!r}?" if self.nearest else ""
        super().__init__(f"no dataset {name!r}{hint}; there are {', '.join(known)}")


def names() -> tuple[str, ...]:
    """Names of all datasets, sorted."""
    return tuple(sorted(_presets()))


def get(name: str) -> Preset:
    """Return the dataset of this name.

    Raises
    ------
    UnknownDatasetError
        Naming the nearest known one.
    """
    presets = _presets()
    if name not in presets:
        raise UnknownDatasetError(name, tuple(sorted(presets)))
    return presets[name]


@cache
def _presets() -> dict[str, Preset]:
    found: dict[str, Preset] = {}
    for module in pkgutil.iter_modules(standard.__path__):
        loaded = importlib.import_module(f"{standard.__name__}.{module.name}")
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
        shown = preset.name in SHOWN_IDEAL
        found[preset.name] = preset.with_ideal_calibration() if shown else preset
    return found
