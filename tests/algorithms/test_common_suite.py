"""What every extractor, compensation and model must do, run on all that discovery finds."""

from __future__ import annotations

import os
import re
from pathlib import Path

import compensation_checks
import extractor_checks
import model_checks
import pytest
import sequence_checks
from compensation_checks import COMPENSATION_CHECKS
from extractor_checks import EXTRACTOR_CHECKS
from model_checks import MODEL_CHECKS
from sequence_checks import SEQUENCE_CHECKS

import algorithms
from algorithms.context import CONTEXT
from algorithms.discovery import (
    discover_compensations,
    discover_extractors,
    discover_models,
)

EXTRACTORS = discover_extractors()
COMPENSATIONS = discover_compensations()
#: Models of single samples, and those that read them in the order of time.
SEQUENCES = {n: m for n, m in discover_models().items() if getattr(m, "sequential", False)}
MODELS = {n: m for n, m in discover_models().items() if n not in SEQUENCES}

RAN: set[tuple[str, str]] = set()


@pytest.mark.parametrize("check", EXTRACTOR_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", EXTRACTORS)
def test_extractor(name, check, design_for, observations_for):
    cls = EXTRACTORS[name]
    RAN.add((name, check.__name__))
    check(cls, cls.for_sensor(design_for(cls)), observations_for(cls))


@pytest.mark.parametrize("check", COMPENSATION_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", COMPENSATIONS)
def test_compensation(name, check, design_for, calibration_for):
    cls = COMPENSATIONS[name]
    RAN.add((name, check.__name__))
    design = design_for(cls)
    for kind in sorted(cls.about.accepts):
        extra = (design,) if "geometry" in check.__code__.co_varnames else ()
        calibration = calibration_for(kind, design).beside(tuple(CONTEXT))
        check(cls, cls.for_sensor(design, kind), calibration, *extra)


@pytest.mark.parametrize("check", MODEL_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", MODELS)
def test_model(name, check, design_for, calibration_for):
    cls = MODELS[name]
    RAN.add((name, check.__name__))
    design = design_for(cls)
    for kind in sorted(cls.about.accepts):
        extra = (design,) if "geometry" in check.__code__.co_varnames else ()
        calibration = calibration_for(kind, design).beside(cls.about.context)
        check(cls, cls.for_sensor(design, kind), calibration, *extra)


@pytest.mark.parametrize("check", SEQUENCE_CHECKS, ids=lambda check: check.__name__)
@pytest.mark.parametrize("name", SEQUENCES)
def test_sequence(name, check, geometry, flight_for):
    cls = SEQUENCES[name]
    RAN.add((name, check.__name__))
    for kind in sorted(cls.about.accepts):
        extra = (geometry,) if "geometry" in check.__code__.co_varnames else ()
        check(cls, cls.for_sensor(geometry, kind), flight_for(kind), *extra)


def test_every_check_ran_on_every_implementation(request):
    """An empty discovery, or a check that lost its decorator, must not look green."""
    source = [
        path.read_text(encoding="utf-8")
        for folder in ("extractors", "compensations", "models")
        for path in (Path(algorithms.__file__).parent / folder).rglob("*.py")
    ]
    declared = sum(
        len(re.findall(r"^    about: ClassVar = (?:About|replace\()", text, re.MULTILINE))
        for text in source
    )
    found = (EXTRACTORS, COMPENSATIONS, MODELS, SEQUENCES)
    assert declared == sum(map(len, found)) >= 14
    assert len(SEQUENCES) >= 8

    written = [
        Path(module.__file__).read_text()
        for module in (extractor_checks, compensation_checks, model_checks, sequence_checks)
    ]
    defined = sum(len(re.findall(r"^def check_", text, re.MULTILINE)) for text in written)
    shared = set(MODEL_CHECKS) & set(SEQUENCE_CHECKS)
    checks = (EXTRACTOR_CHECKS, COMPENSATION_CHECKS, MODEL_CHECKS, SEQUENCE_CHECKS)
    assert defined == sum(map(len, checks)) - len(shared)

    expected = {(name, check.__name__) for name in EXTRACTORS for check in EXTRACTOR_CHECKS}
    expected |= {(name, check.__name__) for name in COMPENSATIONS for check in COMPENSATION_CHECKS}
    expected |= {(name, check.__name__) for name in MODELS for check in MODEL_CHECKS}
    expected |= {(name, check.__name__) for name in SEQUENCES for check in SEQUENCE_CHECKS}
    collected = {
        (item.callspec.params["name"], item.callspec.params["check"].__name__)
        for item in request.session.items
        if item.path == Path(__file__) and hasattr(item, "callspec")
    }
    assert collected == expected
    if "PYTEST_XDIST_WORKER" not in os.environ:  # there each worker runs a share of them
        assert expected == RAN
