"""The leaderboard follows from the results: brought up to date, ranked, shown in every form."""

import dataclasses
import os
import sys

import fake_plan
import pytest
from fake_atlas import Diodes, Gaps, LeastSquares
from fake_results import copied

from benchmark.contract import ON_BENCH
from benchmark.leaderboard.board import board_of
from benchmark.leaderboard.pages import PAGE
from benchmark.leaderboard.scope import UNITS
from benchmark.leaderboard.update import update, write_page
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running import condition_data
from benchmark.running.pinning import UnversionedChangeError
from benchmark.sweeps.record import swept

pytestmark = pytest.mark.usefixtures("readings_only", "log")
PRESETS = (Diodes(), Diodes(name="fake-second"))
PARTS = fake_plan.parts(presets=PRESETS)
#: Every pipeline under both conditions; what leads on other units and, on all of them, on benches.
PLANNED = 8 + 2 * (UNITS - 1) + 2 * UNITS


@pytest.fixture(scope="module")
def made(tmp_path_factory, readings_only):
    condition_data.forget()
    directory = tmp_path_factory.mktemp("published")
    update(directory, progress=silent, parts=PARTS)
    return directory


@pytest.fixture
def published(made, tmp_path):
    """A copy that a test may change."""
    return copied(made, tmp_path / "published")


def states(directory):
    return {
        str(path.relative_to(directory)): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in directory.rglob("*.*")
        if path.is_file() and ".sunatlas" not in path.parts
    }


def changed_lines(before, after):
    """Count lines by file that are not in the other version of it."""
    found = {}
    for name in sorted(before.keys() | after.keys()):
        one, two = (
            state[name][0].decode().splitlines() if name in state else []
            for state in (before, after)
        )
        if one != two and name != "checksums-sha256.txt":  # digests of the others
            found[name] = [line for line in two if line not in one]
    return found


def test_everything_planned_is_measured_and_the_leading_on_other_units(made):
    store = Store(made)
    rows = store.rows(unit=None)
    assert len(store.rows()) == 2 * 2 * 2 + 2, "on drawn benches the leading one"
    assert {row["status"] for row in rows} == {"ok"}
    others = {(row["dataset"], row["condition"], row["unit"]) for row in rows if row["unit"]}
    assert others == {
        (preset.name, condition, unit)
        for preset in PRESETS
        for condition in ("quiet", ON_BENCH)
        for unit in range(1, UNITS)
    }
    assert len(rows) == PLANNED
    assert {row["series"] for row in swept(store.directory)} >= {"faces", "quadrants"}
    assert {place[0] for place in store.pins()} == {preset.name for preset in PRESETS}


def test_bringing_up_to_date_what_is_up_to_date_writes_and_generates_nothing(published, log):
    before = states(published)
    summary = update(published, progress=silent, parts=PARTS)
    assert (summary.computed, summary.failed, summary.warnings) == (0, (), ())
    assert summary.planned == summary.already_stored == PLANNED
    assert states(published) == before
    assert log() == []
    assert not write_page(Store(published))


@pytest.fixture
def plug_in(tmp_path, monkeypatch):
    """An extractor kept in a file of its own, and how to rewrite that file."""
    path = tmp_path / "plugged_in.py"
    text = (
        '"""A plug-in."""\n\nfrom dataclasses import replace\n\n'
        "from fake_atlas import Currents\n\n\n"
        "class Plugged(Currents):\n"
        '    """Adds nothing."""\n\n'
        '    about = replace(Currents.about, name="fake-plugged")\n\n'
        "    def extract(self, observations):\n"
        "        return super().extract(observations) + 0.0\n"
    )
    path.write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    from plugged_in import Plugged

    def rewrite(old, new):
        assert old in text
        path.write_text(text.replace(old, new))
        later = path.stat().st_mtime_ns + 1_000_000
        os.utime(path, ns=(later, later))

    parts = fake_plan.parts(presets=PRESETS[:1])
    extractors = {"fake-gaps": Gaps, "fake-plugged": Plugged}
    yield dataclasses.replace(parts, extractors=extractors), rewrite
    del sys.modules["plugged_in"]


def test_an_extractor_s_new_code_renews_its_own_rows_and_its_digest_alone(tmp_path, plug_in, log):
    """A comment or a docstring renews nothing; a plus that becomes a minus does."""
    parts, rewrite = plug_in
    record = tmp_path / "record"
    update(record, progress=silent, parts=parts)
    before, done = states(record), len(log())
    rewrite('"""Adds nothing."""', '"""Adds nothing at all."""  # or so they say')
    assert update(record, progress=silent, parts=parts).computed == 0
    assert states(record) == before
    assert len(log()) == done

    rewrite("(observations) + 0.0", "(observations) - 0.0")
    assert update(record, progress=silent, parts=parts).computed == 2 + UNITS - 1 + UNITS
    assert {line.split()[1] for line in log()[done:] if line.startswith("extract")} == {
        "fake-plugged"
    }
    moved = changed_lines(before, states(record))
    assert list(moved) == ["components.json", "sweeps.json"], "the numbers are what they were"
    names = [line.partition(": ")[0] for line in moved["components.json"]]
    assert names == ['"fake-plugged"', '"plugged_in"'], "the method and its module"
    assert all("/fake-plugged" in line for line in moved["sweeps.json"])


def test_data_that_change_in_silence_are_an_error_before_anything_is_measured(published, log):
    before = states(published)
    silent_change = fake_plan.parts(presets=(Diodes(), Diodes(name="fake-second", seed=8)))
    with pytest.raises(UnversionedChangeError, match="fake-second") as caught:
        update(published, progress=silent, parts=silent_change)
    assert list(caught.value.changes) == ["fake-second"]
    assert states(published) == before
    assert not [line for line in log() if line.startswith("extract")]
    assert all(" first " in line for line in log() if line.startswith("generate"))
    assert {line.split()[1] for line in log()} == {"fake-second"}, "the other's code is as it was"


def test_what_is_no_longer_planned_goes(published):
    update(published, progress=silent, parts=fake_plan.parts())
    store = Store(published)
    assert {row["dataset"] for row in store.rows(unit=None)} == {"fake-diodes"}
    assert {place[0] for place in store.pins()} == {"fake-diodes"}
    assert list(store.components().datasets) == ["fake-diodes"]
    assert "fake-second" not in (published / PAGE).read_text()


def test_pipelines_that_differ_less_than_units_share_a_rank_in_every_form(tmp_path):
    class Alike(LeastSquares):
        """Turns what the other finds by a thousandth of a degree."""

        about = dataclasses.replace(LeastSquares.about, name="fake-alike")

        def predict(self, features, context=None):
            found = super().predict(features)
            found[:, 0] += 2e-5
            return found / (found**2).sum(axis=1, keepdims=True) ** 0.5

    preset = Diodes(conditions=("nominal", "noisy"))
    parts = fake_plan.parts(LeastSquares, Alike, presets=(preset,))
    update(tmp_path, progress=silent, parts=parts)
    board = board_of(Store(tmp_path))
    rows = [row for row in board["datasets"][0]["rows"] if row["condition"] == "nominal"]
    assert [(row["rank"], row["tied"], row["extractor"]) for row in rows] == [
        (1, True, "fake-currents"),
        (3, False, "fake-gaps"),
        (1, True, "fake-currents"),
        (4, False, "fake-gaps"),
    ]
    first = rows[0]
    assert len(first["unit_rms_deg"]) == UNITS
    assert first["unit_rms_deg"][0] == first["rms_deg"]
    assert first["low_deg"] == min(first["unit_rms_deg"]) < first["high_deg"]
    noisy = [row for row in board["datasets"][0]["rows"] if row["condition"] == "noisy"]
    assert sorted(row["rank"] for row in noisy) == [1, 2, 3, 4], "scored on one unit alone"
    assert (tmp_path / PAGE).read_text().count("| 1= |") == 2
