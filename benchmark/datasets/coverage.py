"""Which detector-mask pairs of the mapped studies a standard dataset simulates.

The table is made from the survey's mapping and the datasets there are.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from benchmark import datasets
from registry.studies import Facts, facts
from survey_data.json_data import JsonData

Pair = tuple[str, str]  # (detector, mask)


@dataclass(frozen=True)
class PairCoverage(JsonData):
    """A pair of the taxonomy, the studies that use it and the datasets that simulate it.

    No pair needs a `reason` why it has no dataset.
    """

    detector: str
    mask: str
    studies: tuple[str, ...]
    datasets: tuple[str, ...]
    reason: str = ""


@dataclass(frozen=True)
class Coverage(JsonData):
    """What the datasets cover of the taxonomy and of the mapped studies.

    Every pair that a study uses or a dataset simulates, in the taxonomy's order; by value of the
    taxonomy, the datasets that have it.
    """

    detectors: Mapping[str, tuple[str, ...]]
    masks: Mapping[str, tuple[str, ...]]
    pairs: tuple[PairCoverage, ...]

    @property
    def used(self) -> tuple[PairCoverage, ...]:
        """Pairs that a study uses."""
        return tuple(pair for pair in self.pairs if pair.studies)

    def sentence(self) -> str:
        """Say the numbers."""
        used = self.used
        simulated = [pair for pair in used if pair.datasets]
        beyond = len(self.pairs) - len(used)
        return (
            f"{_of(self.detectors)} detectors and {_of(self.masks)} masks of the taxonomy are "
            f"simulated, and {len(simulated)} of the {len(used)} detector-mask pairs that the "
            f"mapped studies use; {beyond} simulated pairs are used by no mapped study."
        )


def coverage(*, known: Facts | None = None) -> Coverage:
    """Compare what the mapped studies use with what the standard data sets simulate."""
    mapped = known or facts()
    presets = {name: datasets.get(name) for name in datasets.names()}
    architectures = {name: (p.detector, p.mask) for name, p in presets.items()}
    using: dict[Pair, list[str]] = {}
    for key, study in mapped.studies.items():
        for pair in study.architectures:
            using.setdefault(pair, []).append(key)
    simulating: dict[Pair, list[str]] = {}
    for name, pair in sorted(architectures.items()):
        simulating.setdefault(pair, []).append(name)
    detectors, masks = mapped.taxonomy.values("detector"), mapped.taxonomy.values("mask")
    return Coverage(
        {value: _studies_with(value, 0, architectures) for value in detectors},
        {value: _studies_with(value, 1, architectures) for value in masks},
        tuple(
            PairCoverage(
                *pair,
                tuple(using.get(pair, ())),
                tuple(simulating.get(pair, ())),
            )
            for pair in ((detector, mask) for detector in detectors for mask in masks)
            if pair in using or pair in simulating
        ),
    )


def _studies_with(value: str, place: int, architectures: Mapping[str, Pair]) -> tuple[str, ...]:
    return tuple(name for name, pair in sorted(architectures.items()) if pair[place] == value)


def _of(found: Mapping[str, tuple[str, ...]]) -> str:
    return f"{sum(bool(names) for names in found.values())} of {len(found)}"
