"""Checking the record: an altered, missing or extra number is found and named by its cell."""

import dataclasses

import fake_plan
import pytest
from fake_atlas import Diodes, LeastSquares
from fake_results import copied

from benchmark.contract import Cell
from benchmark.leaderboard import check as checking
from benchmark.leaderboard.check import Difference
from benchmark.leaderboard.pages import PAGE
from benchmark.leaderboard.update import update, write_page
from benchmark.progress import silent
from benchmark.results.csv_tables import StoreError
from benchmark.results.store import Store
from benchmark.running import condition_data

pytestmark = pytest.mark.usefixtures("readings_only", "log")
PARTS = fake_plan.parts(presets=(Diodes(), Diodes(name="fake-second")))
CELL = Cell("fake-diodes", "noisy", "fake-currents", "fake-least-squares")
SCORES = "scores/fake-diodes.csv"


@pytest.fixture(scope="module")
def made(tmp_path_factory, readings_only):
    condition_data.forget()
    directory = tmp_path_factory.mktemp("published")
    update(directory, progress=silent, parts=PARTS)
    return directory


@pytest.fixture
def published(made, tmp_path):
    """A copy that a test may damage; without what would name every damage at once."""
    directory = copied(made, tmp_path / "published")
    (directory / "checksums-sha256.txt").unlink()
    return directory


def check(directory, **options):
    return checking.check(directory, 1, silent, **{"parts": PARTS, **options})


def altered(directory, cell, **changed):
    """Change numbers of a stored score, and bring the page after it."""
    store = Store(directory)
    scores = store.scores()
    scores[cell] = {**scores[cell], **changed}
    store.write(scores, store.pins().values(), store.components())
    write_page(store)


def test_a_record_that_is_as_it_should_be_passes_with_and_without_measuring(published):
    assert check(published, stored_only=True) == []
    assert check(published) == []


def test_a_number_changed_by_hand_is_named_by_its_file(made, tmp_path):
    directory = copied(made, tmp_path / "published")
    assert check(directory, stored_only=True) == []
    path = directory / SCORES
    path.write_text(path.read_text().replace("0.", "1.", 1))
    [difference] = check(directory, stored_only=True)
    assert (difference.file, difference.cell) == (SCORES, "file")
    with pytest.raises(StoreError, match=r"SHA-256 is .*take.*`python"):
        update(directory, progress=silent, parts=PARTS)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("availability", 0.5),
        ("over_bound_se", None),
        ("rms_60_70_deg", 0.123),
        ("status", "refused"),
    ],
)
def test_one_altered_number_is_found_by_measuring_and_named_by_its_cell(published, column, value):
    right = Store(published).scores()[CELL][column]
    altered(published, CELL, **{column: value})
    assert check(published, stored_only=True) == [], "page and digests agree: only measuring tells"
    [difference] = check(published)
    assert difference == Difference(SCORES, f"{CELL}/{column}", str(value), str(right))
    assert str(difference) == (f"{SCORES}: {CELL}/{column} is {value}, should be {right}")


def test_results_of_other_code_are_named_without_measuring(published, log):
    about = dataclasses.replace(LeastSquares.about, version=2)
    newer = type("Newer", (LeastSquares,), {"about": about, "__module__": "fake_atlas"})
    parts = fake_plan.parts(newer, presets=(Diodes(), Diodes(name="fake-second", n=200)))
    found = check(published, stored_only=True, parts=parts)
    conditions = parts.presets["fake-second"].conditions
    cells = {f"datasets/fake-second/{name}" for name in conditions} | {"models/fake-least-squares"}
    assert {d.file for d in found} == {"components.json"}
    assert sorted(d.cell for d in found) == sorted(cells)
    assert {d.measured for d in found} == {"another: code or parameters have changed"}
    assert log() == []


def test_data_that_moved_under_their_version_are_told_before_anything_is_measured(published, log):
    parts = fake_plan.parts(presets=(Diodes(seed=8), Diodes(name="fake-second")))
    found = check(published, parts=parts)
    moved = [d for d in found if d.file == "pins.csv"]
    assert {d.cell for d in moved} == {
        f"fake-diodes/{condition}/{split}"
        for condition in Diodes().conditions
        for split in ("calibration", "test", "repeat")
    }
    assert all("hash" in d.measured for d in moved)
    assert {d.committed for d in moved} == {f"version {Diodes().version}"}
    assert moved == found[: len(moved)]
    assert not [line for line in log() if line.startswith(("extract", "fit"))]


def test_what_is_stored_and_no_longer_there_is_named(published):
    found = check(published, stored_only=True, parts=fake_plan.parts())
    assert {(d.file, d.measured) for d in found} == {
        ("components.json", "not installed"),
        ("scores", "not planned"),
        ("pins.csv", "not pinned"),
    }
    assert all("fake-second" in d.cell for d in found)


def test_what_is_planned_and_not_yet_stored_is_named(published):
    parts = fake_plan.parts(presets=(Diodes(), Diodes(name="fake-second"), Diodes(name="fake-3")))
    found = check(published, stored_only=True, parts=parts)
    assert {(d.file, d.committed) for d in found} == {("scores", "absent"), ("pins.csv", "absent")}
    assert len(found) == 2 + 6, "what follows from the first scores is not known yet"
    assert all("fake-3" in d.cell for d in found)


@pytest.mark.parametrize("name", ["sweeps.csv", "components.json", PAGE])
def test_a_missing_file_is_named(published, name):
    path = published / name
    path.unlink()
    if name == "components.json":
        with pytest.raises(ValueError, match="unknown among the datasets"):
            check(published, stored_only=True)
        return
    found = check(published, stored_only=True)
    assert {d.file for d in found} == {name}
    assert {d.committed for d in found} == {"absent"}


def test_a_changed_page_is_a_named_line(published):
    path = published / PAGE
    right = path.read_text()
    path.write_text(right.replace("# Leaderboard", "# Leader board"))
    [difference] = check(published, stored_only=True)
    assert difference == Difference(PAGE, "line 1", "# Leader board", "# Leaderboard")
    path.write_text(right + "more\n")
    [difference] = check(published, stored_only=True)
    assert (difference.file, difference.cell) == (PAGE, "file")
    path.write_text(right[:-1])
    [difference] = check(published, stored_only=True)
    assert (difference.file, difference.cell) == (PAGE, "file")
