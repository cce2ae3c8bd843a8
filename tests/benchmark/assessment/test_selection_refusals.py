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
from benchmark.assessment.selection import SETTINGS, choices, chosen_and_best, selection_data
from benchmark.experiments.__main__ import main
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


@pytest.mark.parametrize(
    ("poses", "extractors", "chosen"),
    [
        (ENOUGH, (Gaps,), SignalPolynomial),
        (TOO_FEW, (Currents,), SignalPolynomial),
        (ENOUGH, (Currents,), LeastSquares),
    ],
)
def test_what_cannot_be_compared_has_no_choice(
    install: Any, poses: int, extractors: Any, chosen: Any
) -> None:
    """Nothing found, a refused calibration, a model that does not choose."""
    install(diodes(poses), extractors, **{NAME: named(NAME, chosen)})
    assert list(choices(["fake"])) == []


def test_fixed_settings_that_the_samples_do_not_settle_are_left_out() -> None:
    preset = diodes(FEW)
    data = selection_data(preset, Currents)
    assert data is not None
    found = chosen_and_best(model(preset), SETTINGS[NAME], data)
    assert found is not None
    chosen, best, chosen_deg, best_deg = found
    assert best == {"degree": 1}
    assert chosen["degree"] == 1
    assert chosen_deg == best_deg
    unsettled = [{"degree": 5}, {"degree": 6}]
    assert chosen_and_best(model(preset), unsettled, data) is None
    few = selection_data(diodes(TOO_FEW), Currents)
    assert few is not None
    assert chosen_and_best(model(preset), SETTINGS[NAME], few) is None


def test_choices_are_printed_and_fail_where_one_is_a_tenth_worse_than_the_best(
    install: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    install(diodes(ENOUGH), **{NAME: SignalPolynomial})
    assert main(["selection"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("fake fake-currents polynomial-signals 1.000 {'degree': 1, ")
    assert printed.count("\n") == 1
    monkeypatch.setattr("benchmark.experiments.selection.WORST", 0.99)
    assert main(["selection", "fake"]) == 1
    assert capsys.readouterr().out == printed
