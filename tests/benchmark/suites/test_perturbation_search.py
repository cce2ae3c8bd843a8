"""The search for cells that hang on rounding, on a data set and models made for it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np
import pytest
from fake_atlas import Currents, Diodes, FakeSamples, LeastSquares

from algorithms.contract import UnusableDataError
from benchmark.contract import Cell
from benchmark.plan.parts import Parts
from benchmark.running import condition_data
from benchmark.suites.perturbation import SensitiveCell, search


@dataclass(frozen=True)
class Coarse(Diodes):
    """Reads currents in steps of 1/1024, which are exact numbers."""

    name: str = "fake-coarse"
    conditions: tuple[str, ...] = ("quiet",)
    n: int = 60

    def generate(self, condition: str, split: str, n: int | None = None) -> FakeSamples:
        samples = super().generate(condition, split, n)
        return replace(samples, observations=np.round(samples.observations * 1024.0) / 1024.0)


@dataclass(frozen=True)
class Counts(Coarse):
    """The same as counts of those steps."""

    name: str = "fake-counts"

    def generate(self, condition: str, split: str, n: int | None = None) -> FakeSamples:
        samples = super().generate(condition, split, n)
        counts = (samples.observations * 1024.0).astype(np.int64)
        return replace(samples, observations=counts)


def _exact(features: Any) -> Any:
    steps = np.asarray(features) * 1024.0
    return (steps == np.round(steps)).all(axis=1)


@dataclass
class Cliff(LeastSquares):
    """Answers straight ahead unless readings are exact steps."""

    about = replace(LeastSquares.about, name="fake-cliff")

    def predict(self, features: Any, context: Any = None) -> Any:
        ahead = np.array([0.0, 0.0, 1.0])
        return np.where(_exact(features)[:, None], super().predict(features), ahead)


@dataclass
class Fussy(LeastSquares):
    """Refuses to be fitted to other readings than exact steps."""

    about = replace(LeastSquares.about, name="fake-fussy")

    def fit(self, features: Any, sun: Any, context: Any = None) -> Any:
        if not _exact(features).all():
            raise UnusableDataError("needs exact steps")
        return super().fit(features, sun, context)


PRESETS: Any = {"fake-coarse": Coarse(), "fake-counts": Counts()}
MODELS: Any = {model.about.name: model for model in (LeastSquares, Cliff, Fussy)}
PARTS = Parts(PRESETS, {"fake-currents": cast("Any", Currents)}, MODELS)


def cells_of(dataset: str, *models: str) -> list[Cell]:
    return [Cell(dataset, "quiet", "fake-currents", model) for model in models]


@pytest.fixture(autouse=True)
def _forget() -> Iterator[None]:
    yield
    condition_data.forget()


def test_a_model_with_a_cliff_at_exact_numbers_is_found_and_a_smooth_one_is_not() -> None:
    told: list[SensitiveCell] = []
    steps: list[tuple[int, int, str]] = []
    found = search(
        cells_of("fake-coarse", "fake-least-squares", "fake-cliff"),
        PARTS,
        told.append,
        lambda *step: steps.append(cast("tuple[int, int, str]", step)),
    )
    assert found.cells == 2
    assert {one.cell.model for one in found.moved_cells} == {"fake-cliff"}
    assert {one.inputs for one in found.moved_cells} == {"features", "observations"}
    assert tuple(told) == found.sensitive_cells
    assert steps == [(0, 2, "fake-coarse")]

    one = found.moved_cells[0]
    before, after = one.columns["rms_all_answers_deg"]
    assert after > 10.0 * before
    assert str(one) == (
        f"{one.cell} ({one.inputs}): rms_all_answers_deg {before} -> {after}, "
        f"{len(one.columns)} columns differ"
    )


def test_counts_are_not_perturbed() -> None:
    found = search(cells_of("fake-counts", "fake-cliff"), PARTS)
    assert (found.cells, found.sensitive_cells) == (1, ())


def test_a_cell_that_another_rounding_refuses_is_found_with_the_reason() -> None:
    found = search(cells_of("fake-coarse", "fake-fussy"), PARTS, observations=False)
    (one,) = found.moved_cells
    before, after = one.columns["reason"]
    assert before is None
    assert "needs exact steps" in after
    assert one.columns["rms_all_answers_deg"][1] is None
