"""`sunatlas plan`, `run --suite`, `verify` and `gc`: what they say, and their exit codes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli import measuring
from api.cli.command_line import app
from benchmark.contract import Cell
from benchmark.leaderboard.scope import UNITS, first
from benchmark.plan.combinations import cells
from benchmark.plan.parts import Parts, installed_parts
from benchmark.results.store import PUBLISHED, Store
from benchmark.running.runner import run
from benchmark.suites import planning
from files import manifest


def sunatlas(*arguments: object) -> Any:
    return CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)


@pytest.fixture
def working(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty working store; what is published stays."""
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "working"))
    return tmp_path / "working"


@pytest.fixture
def small(working: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Two small data sets with one model are all there is, and nothing is published."""
    known = installed_parts()
    names = ("pd-maskless-cube", "qpd-single-aperture")
    few = Parts(
        {name: known.presets[name] for name in names},
        {name: known.extractors[name] for name in ("direct", "voltage-balance")},
        {name: known.models[name] for name in ("basic", "qpd")},
    )
    monkeypatch.setattr(planning, "every_part", lambda: few)
    monkeypatch.setattr(measuring, "PUBLISHED", working.parent / "published")
    return working


@pytest.mark.slow
def test_nothing_of_the_published_code_is_planned_and_run_reads_it(working: Path) -> None:
    for suite in ("quick", "standard"):
        planned = sunatlas("plan", "--suite", suite, "--format", "json")
        found = json.loads(planned.stdout)
        assert (found["suite"], found["missing"]) == (suite, [])
        assert f"0 of {found['planned']} cells to be measured" in planned.stderr
    shown = json.loads(sunatlas("run", "--suite", "quick", "--format", "json").stdout)
    published = Store(PUBLISHED).scores()
    assert shown["sources"]["measured"] == shown["sources"]["kept"] == 0
    assert shown["scores"]
    for row in shown["scores"]:
        cell = Cell(row["dataset"], row["condition"], row["extractor"], row["model"])
        assert row["rms_deg"] == published[cell]["rms_deg"]
    assert not working.exists()


@pytest.mark.slow
def test_a_suite_is_planned_run_and_then_there(small: Path) -> None:
    planned = sunatlas("plan", "--format", "json")
    document = json.loads(planned.stdout)
    assert {row["why"] for row in document["missing"]} == {"new"}
    # the first condition only: what follows depends on the scores
    assert {row["condition"] for row in document["missing"]} == {"nominal"}
    table = sunatlas("plan").stdout
    assert "standard: to be measured" in table
    assert table.count("new") == 2, "a row a data set"

    done = json.loads(sunatlas("run", "--suite", "standard", "--format", "json").stdout)
    measured = Store(small).scores()
    assert done["sources"]["measured"] == len(measured) > len(document["missing"])
    assert done["sources"]["published"] == done["sources"]["kept"] == 0
    assert {cell.unit for cell in measured} == set(range(UNITS))
    again = json.loads(sunatlas("run", "--suite", "standard", "--format", "json").stdout)
    assert again["scores"] == done["scores"]
    assert again["sources"]["kept"] == len(measured)
    assert "0 of" in sunatlas("plan").stderr


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("run",), "study's key and --suite"),
        (("run", "Chang2008", "--suite", "quick"), "study's key and --suite"),
        (("run", "--suite", "quick", "--condition", "nominal"), "--condition goes with a study"),
        (("verify", "--sample", "0"), "--sample: got 0"),
        (("gc", "--store", str(PUBLISHED)), "`sunatlas leaderboard`"),
    ],
)
def test_a_wrong_call_is_one_line_that_says_what_is_right(
    arguments: tuple[str, ...], said: str
) -> None:
    called = CliRunner().invoke(app, list(arguments))
    assert called.exit_code != 0
    assert said in " ".join(called.stderr.split())
    assert "Traceback" not in called.stderr


@pytest.fixture
def published(small: Path) -> Store:
    """A record of the small plan."""
    store = Store(measuring.PUBLISHED)
    run(first(planning.every_part()), store, progress=lambda *_told: None)
    return store


def test_a_record_that_holds_is_verified_and_nothing_is_written(
    published: Store, small: Path
) -> None:
    before = {path: path.read_bytes() for path in published.directory.rglob("*.csv")}
    told = ("verify", "--sample", "1", "--seed", "7", "--workers", "1", "--format", "json")
    verified = sunatlas(*told)
    assert verified.exit_code == 0, verified.stderr
    assert "2 cells, drawn by --seed 7" in verified.stderr
    assert "1 of 1" in verified.stderr
    drawn = json.loads(verified.stdout)
    assert (len(drawn["cells"]), drawn["alike"], drawn["differences"]) == (1, 1, [])
    assert drawn["seed"] == 7
    assert {path: path.read_bytes() for path in published.directory.rglob("*.csv")} == before
    assert not small.exists()


@pytest.mark.slow
def test_a_number_that_does_not_hold_fails_with_its_cell(published: Store) -> None:
    path = published.scores_directory / "qpd-single-aperture.csv"
    (cell,) = (cell for cell in published.scores() if cell.dataset == path.stem)
    right = published.scores()[cell]["rms_deg"]
    path.write_text(path.read_text().replace(f",{right!r},", f",{2 * right!r},", 1))
    verified = sunatlas("verify", "--suite", "quick", "--workers", "1", "--format", "json")
    assert verified.exit_code == 1
    (difference,) = json.loads(verified.stdout)["differences"]
    assert difference["cell"] == f"{cell}/rms_deg"
    assert (float(difference["committed"]), float(difference["measured"])) == (2 * right, right)
    assert "sunatlas: 1 differences, the first: scores/qpd-single-aperture.csv" in verified.stderr


def test_nothing_published_is_nothing_to_verify(small: Path) -> None:
    assert "nothing is published in" in CliRunner().invoke(app, ["verify"]).stderr


def bytes_without_manifest(folder: Path) -> int:
    """The manifest is written anew with what it tells of."""
    files = (path for path in folder.rglob("*") if path.is_file())
    return sum(path.stat().st_size for path in files if path.name != manifest.FILE)


@pytest.mark.slow
def test_gc_tells_and_with_yes_does(working: Path) -> None:
    store = Store(working)
    wanted = cells("pd-maskless-cube", "nominal", models="basic")
    run(wanted, store, progress=lambda *_told: None)
    line = '"direct": {"version": 1'
    text = store.components_path.read_text()
    (digest,) = (row for row in text.splitlines() if row.startswith(line))
    other = f'{digest[: digest.rindex(": ")]}: "0123456789abcdef"}}'
    store.components_path.write_text(text.replace(digest.rstrip(","), other))
    (working / manifest.FILE).unlink()  # else a change by hand, which is refused
    document = json.loads(sunatlas("gc", "--format", "json").stdout)
    assert (document["done"], document["scores"], document["kept"]) == (False, 1, 0)
    assert document["freed"] > 0
    assert len(store.scores()) == 1
    size = bytes_without_manifest(working)
    done = sunatlas("gc", "--yes")
    assert f"{document['freed']:,} bytes freed" in done.stderr
    assert store.scores() == {}
    assert size - bytes_without_manifest(working) == document["freed"]
