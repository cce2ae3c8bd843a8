"""Choices that cannot be compared: too few samples found, nothing to choose, a refused fit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import pytest
from fake_atlas import Currents, Diodes, Gaps, LeastSquares

from algorithms.calibration.calibrated import CalibratedModel
from algorithms.contract import FeatureKind
from algorithms.models.non_physical.signal_polynomial import SignalPolynomial
from benchmark.assessment import selection
from benchmark.assessment.selection import SETTINGS, choices, selection_data
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts

NAME = "polynomial-signals"
#: Of four signals: a polynomial of degree 1 has 5 terms, one of degree 6 has 210.
ENOUGH, FEW, TOO_FEW = 40, 12, 5


def diodes(poses: int) -> Diodes:
    return Diodes(name="fake", conditions=("nominal",), n=poses)


def model(preset: Diodes) -> CalibratedModel:
    made = SignalPolynomial.for_sensor(preset.geometry, FeatureKind.SIGNALS)
    assert isinstance(made, CalibratedModel)
    return made


def named(name: str, model: Any) -> Any:
    return type("Named", (model,), {"about": replace(model.about, name=name)})


@pytest.fixture
def install(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a function that installs one data set, and two extractors and a model for it."""

    def installed(preset: Diodes, extractors: Any = (Gaps, Currents), **models: Any) -> None:
        parts = Parts(
            {preset.name: preset}, {one.about.name: one for one in extractors}, dict(models)
        )
        monkeypatch.setattr(selection, "SETTINGS", {name: SETTINGS[name] for name in models})
        monkeypatch.setattr(selection, "installed_parts", lambda: parts)
        planned = partial(cells, parts=parts)
        monkeypatch.setattr(selection, "cells", planned)
        monkeypatch.setattr("benchmark.experiments.selection.SETTINGS", selection.SETTINGS)
        monkeypatch.setattr("benchmark.experiments.selection.cells", planned)

    return installed


def test_an_extractor_that_finds_three_samples_of_four_is_passed_over(
    install: Any, log: Callable[[], list[str]]
) -> None:
    preset = diodes(ENOUGH)
    assert selection_data(preset, Gaps) is None
    found = selection_data(preset, Currents)
    assert found is not None
    assert found.features.shape == found.asked.shape == (ENOUGH, 4)
    install(preset, lut=named("lut", LeastSquares), **{NAME: SignalPolynomial})
    before = len(log())
    (choice,) = choices(["fake"])
    assert sum("extract" in line for line in log()[before:]) == 4, "once for both models"
    assert (choice.dataset, choice.extractor, choice.model) == ("fake", "fake-currents", NAME)
    assert choice.chosen["degree"] == choice.best["degree"] == 1, "currents are linear in the Sun"
    assert choice.ratio == 1.0
    assert 0.05 < choice.best_deg < 0.2
