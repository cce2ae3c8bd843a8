"""What a plan is made of: the datasets and implementations that are installed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from algorithms.chain import Scored
from algorithms.contract import Extractor
from benchmark.contract import Cell, UnknownNameError

if TYPE_CHECKING:
    from benchmark.datasets.preset import Preset


@dataclass(frozen=True)
class Parts:
    """Datasets and implementations by name; the plan's raw material."""

    presets: Mapping[str, Preset]
    extractors: Mapping[str, type[Extractor]]
    models: Mapping[str, Scored]

    def preset(self, name: str) -> Preset:
        """Return the dataset of that name; UnknownNameError otherwise."""
        if name not in self.presets:
            raise UnknownNameError("dataset", name, self.presets)
        return self.presets[name]

    def extractor(self, name: str) -> type[Extractor]:
        """Return the extractor class of that name; UnknownNameError otherwise."""
        if name not in self.extractors:
            raise UnknownNameError("extractor", name, self.extractors)
        return self.extractors[name]

    def model(self, name: str) -> Scored:
        """Return the model, or chain of them, of that name; UnknownNameError otherwise."""
        if name not in self.models:
            raise UnknownNameError("model", name, self.models)
        return self.models[name]

    def of_extractors(self) -> Parts:
        """Return the extractors alone."""
        return Parts({}, self.extractors, {})

    def only(self, cells: Iterable[Cell]) -> Parts:
        """Return the parts that these cells are made of; UnknownNameError for one that is none."""
        wanted = list(cells)
        return Parts(
            {name: self.preset(name) for name in {cell.dataset for cell in wanted}},
            {name: self.extractor(name) for name in {cell.extractor for cell in wanted}},
            {name: self.model(name) for name in {cell.model for cell in wanted}},
        )


@cache
def installed_parts() -> Parts:
    """Everything found by discovery in `benchmark.datasets` and `algorithms`."""
    from algorithms.discovery import discover_chains, discover_extractors  # noqa: PLC0415 - slow
    from benchmark import datasets  # noqa: PLC0415 - loads the simulator

    return Parts(
        presets={name: datasets.get(name) for name in datasets.names()},
        extractors=discover_extractors(),
        models=discover_chains(),
    )


@cache
def study_parts() -> Parts:
    """Return the sensors of single studies, and every implementation."""
    from benchmark import datasets  # noqa: PLC0415 - loads the simulator

    known = installed_parts()
    presets = {name: datasets.get(name) for name in datasets.study_names()}
    return Parts(presets, known.extractors, known.models)


@cache
def every_part() -> Parts:
    """Return standard data sets and sensors of single studies, and every implementation."""
    known = installed_parts()
    presets = {**known.presets, **study_parts().presets}
    return Parts(presets, known.extractors, known.models)


def split_parts(parts: Parts) -> tuple[Parts, Parts]:
    """Divide parts into those of standard data sets and those of sensors of single studies."""
    from benchmark import datasets  # noqa: PLC0415 - loads the simulator

    own = frozenset(datasets.study_names())
    halves: tuple[dict[str, Preset], dict[str, Preset]] = ({}, {})
    for name, preset in parts.presets.items():
        halves[name in own][name] = preset
    standard, studies = (Parts(half, parts.extractors, parts.models) for half in halves)
    return standard, studies
