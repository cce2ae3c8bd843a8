"""Which detector-mask pairs of the mapped studies a standard dataset simulates.

The table is made from the survey's mapping and the datasets there are. Typed are only the reasons
of pairs that no dataset has; one that is missing, or no longer needed, is an error.
"""

from __future__ import annotations

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from types import MappingProxyType

from benchmark import datasets
from registry.studies import Facts, facts
from survey_data.json_data import JsonData

Pair = tuple[str, str]  # (detector, mask)

#: Why no dataset simulates a pair that the mapping gives a study.
REASONS: Mapping[Pair, str] = MappingProxyType({})


class CoverageError(ValueError):
    """A pair has neither dataset nor reason, or a reason it does not need."""


@dataclass(frozen=True)
class PairCoverage(JsonData):
    """A pair of the taxonomy, the studies that use it and the datasets that simulate it.

    Exactly one of `datasets` and `reason` is there; a pair without studies has datasets.
    """

    detector: str
    mask: str
    studies: tuple[str, ...]
    datasets: tuple[str, ...]
    reason: str


@dataclass(frozen=True)
class Coverage(JsonData):
    """What the datasets cover of the taxonomy and of the mapped studies.

    Attributes
    ----------
    pairs
        Every pair that a study uses or a dataset simulates, in the taxonomy's order.
    detectors, masks
        By value of the taxonomy, the datasets that have it.
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


def coverage(
    architectures: Mapping[str, Pair] | None = None,
    *,
    known: Facts | None = None,
    reasons: Mapping[Pair, str] = REASONS,
) -> Coverage:
    """Compare what the mapped studies use with what is simulated.

    `architectures` are (detector, mask) by name of the data set. CoverageError names the pairs that
    have neither data set nor reason, or a reason that they do not need.
    """
    mapped = known or facts()
    if architectures is None:
        presets = {name: datasets.get(name) for name in datasets.names()}
        architectures = {name: (p.detector, p.mask) for name, p in presets.items()}
    using: dict[Pair, list[str]] = {}
    for key, study in mapped.studies.items():
        for pair in study.architectures:
            using.setdefault(pair, []).append(key)
    simulating: dict[Pair, list[str]] = {}
    for name, pair in sorted(architectures.items()):
        simulating.setdefault(pair, []).append(name)
    _check(using.keys(), simulating.keys(), reasons)
    detectors, masks = mapped.taxonomy.values("detector"), mapped.taxonomy.values("mask")
    return Coverage(
        {value: _studies_with(value, 0, architectures) for value in detectors},
        {value: _studies_with(value, 1, architectures) for value in masks},
        tuple(
            PairCoverage(
                *pair,
                tuple(using.get(pair, ())),
                tuple(simulating.get(pair, ())),
                reasons.get(pair, ""),
            )
            for pair in ((detector, mask) for detector in detectors for mask in masks)
            if pair in using or pair in simulating
        ),
    )


def _check(
    using: AbstractSet[Pair], simulating: AbstractSet[Pair], reasons: Mapping[Pair, str]
) -> None:
    wrong = [
        (using - simulating - reasons.keys(), "has neither a dataset nor a reason why it has none"),
        (reasons.keys() & simulating, "is simulated and has a reason why it is not"),
        (reasons.keys() - using, "has a reason why it is not simulated and is used by no study"),
    ]
    found = [
        f"{detector} {mask} {what}" for pairs, what in wrong for detector, mask in sorted(pairs)
    ]
    if found:
        raise CoverageError("; ".join(found))


def _studies_with(value: str, place: int, architectures: Mapping[str, Pair]) -> tuple[str, ...]:
    return tuple(name for name, pair in sorted(architectures.items()) if pair[place] == value)


def _of(found: Mapping[str, tuple[str, ...]]) -> str:
    return f"{sum(bool(names) for names in found.values())} of {len(found)}"
