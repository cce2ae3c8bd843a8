"""Implementations that only say what they are, and the plan of what would be scored of them."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar

from algorithms.chain import Chain
from algorithms.contract import (
    AboutCompensation,
    AboutExtractor,
    AboutModel,
    FeatureKind,
    Observation,
)
from registry.catalogue import Catalogue
from registry.studies import Facts
from registry.taxonomy import Plan


def implementation(
    name: str, taxonomy: str, reads: Observation | None, kinds: frozenset[FeatureKind]
) -> type[Any]:
    """A class that declares what the catalogue reads; nothing here runs it."""

    stated: dict[str, Any] = {
        "name": name,
        "taxonomy": taxonomy,
        "labels": ("eq:x",),
        "origin": "survey",
    }

    @dataclass(frozen=True)
    class Stated:
        """Says what it is.

        Not shown in a list.
        """

        about: ClassVar = (
            AboutModel(accepts=kinds, **stated)
            if reads is None
            else AboutExtractor(observation=reads, kind=next(iter(kinds)), **stated)
        )

    return Stated


def stand_ins(facts: Facts, extractors: list[type[Any]], models: list[type[Any]]) -> Catalogue:
    return Catalogue(
        {e.about.name: e for e in extractors}, {m.about.name: m for m in models}, facts.taxonomy
    )


SPOT, BALANCE, SIGNALS = FeatureKind.SPOT, FeatureKind.BALANCE, FeatureKind.SIGNALS
BCTM = implementation("bctm", "BCTM", Observation.FRAMES, frozenset({SPOT}))
BCM = implementation("bcm", "BCM", Observation.FRAMES, frozenset({SPOT}))
DIRECT = implementation("direct", "Direct", Observation.CURRENTS, frozenset({SIGNALS}))
VB = implementation("vb", "Voltage balance", Observation.CURRENTS, frozenset({BALANCE}))
SPM = implementation("spm", "SPM", None, frozenset({SPOT}))
LUT = implementation("lut", "LUT", None, frozenset({SPOT, BALANCE}))
NOISE = implementation("noise", "ECM/Noise", None, frozenset({SIGNALS}))
ANGULAR = implementation("kelly", "ECM/Angular loss", None, frozenset({SIGNALS}))
BASIC = implementation("basic", "Basic", None, frozenset({SIGNALS}))


def compensation(name: str, taxonomy: str, kinds: frozenset[FeatureKind]) -> type[Any]:
    """A compensation that declares what a chain reads."""

    @dataclass
    class Stated:
        """Says what it is."""

        about: ClassVar = AboutCompensation(name=name, taxonomy=taxonomy, accepts=kinds)

    return Stated


GLASS = compensation("glass", "OCM", frozenset({SPOT, BALANCE}))
SHADE = compensation("shade", "ICM/Shadow", frozenset({SPOT}))
EXTRACTORS = [BCTM, BCM, DIRECT, VB]
MODELS = [SPM, LUT, NOISE, ANGULAR, BASIC]


#: What each detector of these tests gives.
READOUTS = {
    "CMOS": {"frames"},
    "CCD": {"frames", "profiles"},
    "PD": {"currents"},
    "QPD": {"currents"},
    "Event": {"events"},
}


def planned(
    architectures: Iterable[tuple[str, str]],
    extractors: Iterable[Any] = EXTRACTORS,
    models: Iterable[Any] = MODELS,
    without: Iterable[str] = (),
) -> Plan:
    """Every pair that fits, on a data set of its own for each architecture."""
    return {
        (detector, mask): {
            (e.about.name, m.about.name): (f"{detector}-{mask}",)
            for e in extractors
            for m in models
            if str(e.about.observation) in READOUTS[detector]
            and e.about.kind in m.about.accepts
            and m.about.name not in without
        }
        for detector, mask in architectures
    }


def chain(*stages: type[Any]) -> Chain:
    return Chain(tuple(stages[:-1]), stages[-1])


def study_of(**values: list[str]) -> dict[str, list[str]]:
    """Values of a study, of these alone where nothing else is said."""
    return {
        "detector": ["CMOS"],
        "mask": ["Slit"],
        "extractor": ["BCTM"],
        "model": ["SPM"],
    } | values
