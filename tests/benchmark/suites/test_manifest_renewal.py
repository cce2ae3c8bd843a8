"""`python -m benchmark.suites.manifest_renewal`: what was changed by hand is named, then taken."""

from __future__ import annotations

from pathlib import Path

import fake_atlas
import fake_plan
import pytest

from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running.runner import run
from benchmark.suites import manifest_renewal
from benchmark.suites.manifest_renewal import main

PARTS = fake_plan.parts(fake_atlas.LeastSquares)


@pytest.fixture
def record(tmp_path: Path) -> Store:
    store = Store(tmp_path / "record")
    run(cells(parts=PARTS), store, progress=silent, parts=PARTS)
    return store


def test_nothing_that_is_published_was_changed_by_hand(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--check"]) == 0
    assert capsys.readouterr().err == ""


def test_a_change_by_hand_is_named_until_it_is_taken_over(
    record: Store, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(manifest_renewal.facts_manifest, "renew", list)
    (path,) = record.scores_directory.glob("*.csv")
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:-1]))
    asked = ["--directory", str(record.directory)]
    assert main(asked) == 0
    capsys.readouterr()
    assert main([*asked, "--check"]) == 0
    path.write_text("".join(lines))
    assert main([*asked, "--check"]) == 1
    assert path.name in capsys.readouterr().err
    assert main(asked) == 0
    assert capsys.readouterr().err == f"scores/{path.name} taken over\n"
    assert main([*asked, "--check"]) == 0
    path.write_text(lines[0] + "no,score\n")
    assert main(asked) == 1
    assert path.name in capsys.readouterr().err
