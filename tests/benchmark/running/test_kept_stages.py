"""No stage is made twice: what changes is measured again from the first stage it touches."""

import dataclasses
import shutil

import fake_atlas
import fake_plan
import pytest

from benchmark.contract import ON_BENCH
from benchmark.plan import combinations as plan
from benchmark.results import components as components_of
from benchmark.results.digests import stage_digests
from benchmark.results.stage_files import LIMIT_GB
from benchmark.results.store import Store
from benchmark.running import condition_data, runner
from benchmark.running.kept_stages import StageCounts
from benchmark.suites.planning import plan as planned

DIODES, SECOND = fake_atlas.Diodes(), fake_atlas.Diodes(name="fake-second")


@pytest.fixture(autouse=True)
def _memory_is_empty():
    condition_data.forget()


def parts(*models, presets=(DIODES, SECOND)):
    return fake_plan.parts(*models, presets=presets)


def wanted(known):
    found = plan.cells(parts=known)
    first = [cell for cell in found if cell.condition == "quiet"]
    benches = [dataclasses.replace(cell, condition=ON_BENCH) for cell in first]
    return [*found, *benches, *(dataclasses.replace(cell, unit=1) for cell in first)]


def measured(store, known, **more):
    condition_data.forget()
    return runner.run(wanted(known), store, parts=known, progress=lambda *_: None, **more)


def numbers(store):
    return store.scores(), store.pins()


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path / "store")


@pytest.fixture
def doings(log, monkeypatch):
    """Return a function that says what was really done since it was last asked."""
    fits: list[str] = []
    fit = fake_atlas.LeastSquares.fit

    def counted(self, *arguments):
        fits.append("fit")
        return fit(self, *arguments)

    monkeypatch.setattr(fake_atlas.LeastSquares, "fit", counted)
    seen = 0

    def done():
        nonlocal seen
        lines = log()
        found = {line.split()[0] for line in [*lines[seen:], *fits]}
        seen = len(lines)
        fits.clear()
        return found

    return done


@pytest.mark.slow
def test_numbers_are_the_same_without_kept_stages_with_them_and_from_them(tmp_path, doings):
    known = parts()
    stores = [Store(tmp_path / name) for name in ("none", "cold", "warm")]
    measured(stores[0], known, keep_stages=False)
    assert not (stores[0].work_directory / "stages").exists()
    doings()
    measured(stores[1], known)
    assert {"generate", "bound", "extract", "fit"} <= doings()
    shutil.copytree(stores[1].work_directory / "stages", stores[2].work_directory / "stages")
    measured(stores[2], known)
    assert doings() == set(), "everything was kept"
    assert numbers(stores[0]) == numbers(stores[1]) == numbers(stores[2])
    first, *others = (
        {path.name: path.read_bytes() for path in one.scores_directory.iterdir()} for one in stores
    )
    assert others == [first, first]


def test_another_metric_renders_nothing_and_fits_nothing(store, doings, monkeypatch):
    known = parts()
    measured(store, known)
    before = numbers(store)
    doings()
    now = stage_digests()
    monkeypatch.setattr(components_of, "stage_digests", lambda *_: {**now, "scores": "0123"})
    found = planned(wanted(known), [store], parts=known)
    cells = len(wanted(known))
    assert found.stages == StageCounts(data=0, features=0, predictions=0, scores=cells)
    assert measured(store, known).computed == cells
    assert doings() == set()
    assert numbers(store) == before


def test_another_extractor_renders_nothing(store, doings):
    known = parts()
    measured(store, known)
    doings()
    about = dataclasses.replace(fake_atlas.Gaps.about, version=2)
    newer = type("Newer", (fake_atlas.Gaps,), {"about": about, "__module__": "fake_atlas"})
    after = dataclasses.replace(known, extractors={**known.extractors, "fake-gaps": newer})
    found = planned(wanted(after), [store], parts=after)
    mine = [cell for cell in wanted(after) if cell.extractor == "fake-gaps"]
    assert set(found.missing) == set(mine)
    # on drawn benches it looks at what it saw under the first condition
    looks = len({(cell.dataset, cell.condition, cell.unit) for cell in mine}) - 2
    assert found.stages == StageCounts(0, looks, len(mine), len(mine))
    measured(store, after)
    assert "generate" not in (seen := doings())
    assert {"extract", "fit"} <= seen


def test_another_model_extracts_nothing(store, doings):
    known = parts()
    measured(store, known)
    doings()
    about = dataclasses.replace(fake_atlas.LeastSquares.about, name="fake-newer")
    newer = type("Newer", (fake_atlas.LeastSquares,), {"about": about, "__module__": "fake_atlas"})
    after = parts(fake_atlas.LeastSquares, newer)
    measured(store, after)
    assert doings() == {"fit"}


def test_another_data_set_touches_its_own_cells(store, log):
    known = parts()
    measured(store, known)
    before = len(log())
    after = parts(presets=(DIODES, dataclasses.replace(SECOND, seed=8, version=2)))
    found = planned(wanted(after), [store], parts=after)
    assert {cell.dataset for cell in found.missing} == {"fake-second"}
    assert found.stages.data == 3, "two conditions, and another unit under the first"
    measured(store, after)
    generated = [line for line in log()[before:] if line.startswith("generate")]
    assert generated
    assert all("fake-second" in line for line in generated)


def test_a_refusal_is_kept_and_a_failure_is_not(store, doings):
    known = parts(fake_atlas.Broken)
    measured(store, known)
    doings()
    assert {row["status"] for row in store.scores().values()} == {"failed"}
    assert measured(store, known).computed == len(wanted(known))
    assert "generate" not in doings()


def test_any_number_of_workers_shares_what_is_kept(tmp_path):
    known = parts()
    one, two = Store(tmp_path / "one"), Store(tmp_path / "two")
    measured(one, known)
    measured(two, known, workers=2)
    assert numbers(one) == numbers(two)
    keys = [{p.name for p in (s.work_directory / "stages").glob("??/*")} for s in (one, two)]
    assert keys[0] == keys[1] != set()


def test_what_is_kept_beside_another_store_is_read_and_left_alone(store, tmp_path, doings):
    known = parts()
    measured(store, known)
    doings()
    mine = Store(tmp_path / "mine")
    cells = wanted(known)
    nothing = StageCounts(data=0, features=0, predictions=0, scores=len(cells))
    now = planned(cells, [Store(tmp_path / "no scores"), mine], parts=known)
    assert now.stages.predictions == now.stages.scores == len(cells)
    (store.directory / "scores").rename(tmp_path / "scores")
    before = planned(cells, [store, mine], parts=known)
    assert before.stages == nothing
    kept = {path: path.stat().st_size for path in store.directory.rglob("*") if path.is_file()}
    assert measured(mine, known, others=[store]).computed == len(cells)
    assert doings() == set()
    assert kept == {
        path: path.stat().st_size for path in store.directory.rglob("*") if path.is_file()
    }
    assert not (mine.work_directory / "stages").exists()


def test_nothing_is_kept_where_the_limit_is_none(store, monkeypatch):
    monkeypatch.setenv(LIMIT_GB, "0")
    known = parts()
    measured(store, known)
    assert not (store.work_directory / "stages").exists()
    assert planned(wanted(known), [store], parts=known).stages == StageCounts(0, 0, 0, 0)
