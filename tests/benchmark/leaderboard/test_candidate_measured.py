"""A new algorithm is measured on its board; what the record has and is unchanged stays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import fake_plan
import numpy as np
import pytest
from fake_atlas import Broken, Diodes, Framed, LeastSquares

from benchmark.contract import ON_BENCH
from benchmark.leaderboard import scope
from benchmark.leaderboard.candidate import Ranking, UnfitError, rank
from benchmark.leaderboard.scope import UNITS
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running import condition_data
from benchmark.running.runner import run

PRESET = Diodes(n=60)
BEST = ("fake-currents", "fake-least-squares")


class Worse(LeastSquares):
    """The same, and wrong by a degree."""

    about = replace(LeastSquares.about, name="fake-worse")

    def predict(self, features: Any, context: Any = None) -> Any:
        found = super().predict(features, context) + np.array([0.02, 0.0, 0.0])
        return found / np.linalg.norm(found, axis=1, keepdims=True)


@pytest.fixture(scope="module", autouse=True)
def unstudied() -> Iterator[None]:
    """Fakes that no study used: to find that out costs seconds."""
    condition_data.forget()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scope, "studies_of_pipelines", dict)
        patch.setattr(scope, "studied_pipelines", lambda _parts: frozenset())
        yield


def known(*models: Any) -> Parts:
    parts: Parts = fake_plan.parts(*models, presets=(PRESET,))
    return parts


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Store:
    """A record of one model, as the rule of the board has it."""
    store, parts = Store(tmp_path_factory.mktemp("record")), known(LeastSquares)
    first = scope.first(parts)
    run(first, store, 1, silent, parts=parts)
    run([*first, *scope.followers(store.scores(), parts, ())], store, 1, silent, parts=parts)
    return store


def ranked(name: str, record: Store, work: Path, parts: Parts) -> Ranking:
    return rank(name, "fake-diodes", record, Store(work), progress=silent, parts=parts)


def test_a_new_model_is_measured_and_stands_among_those_of_the_record(
    record: Store, tmp_path: Path
) -> None:
    before = {path: path.read_bytes() for path in record.directory.rglob("*.csv")}
    found = ranked("fake-worse", record, tmp_path, known(LeastSquares, Worse))
    pairs = {("fake-currents", "fake-worse"), ("fake-gaps", "fake-worse")}
    assert found.pipelines == pairs
    assert found.measured == 2, "both on the standard unit alone: far behind the first"
    assert len(found.rows) == 4
    assert (found.rows[0]["extractor"], found.rows[0]["model"]) == BEST
    worse = [row["rms_deg"] for row in found.rows if row["model"] == "fake-worse"]
    assert all(1.0 < error < 1.2 for error in worse), "0.02 rad are 1.15 deg"
    assert {(row["extractor"], row["model"]) for row in found.rows if found.has(row)} == pairs
    assert found.scope.startswith("Scored here: its 2 pipelines on the standard unit. ")
    assert {path: path.read_bytes() for path in record.directory.rglob("*.csv")} == before


def test_a_leader_is_scored_on_the_units_and_benches_of_the_board(tmp_path: Path) -> None:
    """Where nothing else is on it."""
    found = ranked("fake-currents", Store(tmp_path / "none"), tmp_path / "work", known())
    assert found.measured == 1 + (UNITS - 1) + UNITS
    assert found.scope == (
        f"Scored here: fake-currents + fake-least-squares on {UNITS} units and drawn benches of "
        f"{UNITS} units, as the board's rule has it."
    )
    work = Store(tmp_path / "work").scores()
    assert {cell.condition for cell in work} == {"quiet", ON_BENCH}
    again = ranked("fake-currents", Store(tmp_path / "none"), tmp_path / "work", known())
    assert again.measured == 0, "the working store has all of it"
    assert again.rows == found.rows


def test_what_the_record_has_of_the_same_code_is_not_measured_again(
    record: Store, tmp_path: Path
) -> None:
    found = ranked("fake-least-squares", record, tmp_path / "work", known())
    assert found.measured == 0
    scores = record.scores()
    kept = [row for row in found.rows if row["model"] == "fake-least-squares"]
    assert len(kept) == 2
    for row in kept:
        cells = [c for c in scores if (c.extractor, c.unit) == (row["extractor"], 0)]
        (cell,) = [c for c in cells if c.condition == "quiet"]
        assert row["rms_deg"] == scores[cell]["rms_deg"]


@pytest.mark.parametrize(
    ("name", "extractors", "said"),
    [
        ("fake-framed", (Framed,), "fake-framed does not fit fake-diodes: .*frames"),
        ("fake-broken", (), "fake-broken does not fit fake-diodes: no pipeline has it"),
    ],
)
def test_an_algorithm_without_a_pipeline_is_refused(
    name: str, extractors: tuple[Any, ...], said: str, tmp_path: Path
) -> None:
    parts = Parts(
        {PRESET.name: PRESET},
        {one.about.name: one for one in extractors},
        {Broken.about.name: Broken},
    )
    with pytest.raises(UnfitError, match=said):
        ranked(name, Store(tmp_path / "none"), tmp_path / "work", parts)
