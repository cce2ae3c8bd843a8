"""A change by hand is named, and taken over only where everything can be read."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from benchmark.results.store import PUBLISHED
from benchmark.suites import manifest_renewal

pytestmark = pytest.mark.slow


@pytest.fixture
def record(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the published record; facts stay out of it."""
    monkeypatch.setattr(manifest_renewal.facts_manifest, "renew", list)
    copied = tmp_path / "record"
    shutil.copytree(PUBLISHED, copied, ignore=shutil.ignore_patterns(".sunatlas"))
    return copied


def test_the_published_record_and_facts_are_as_their_manifests_say() -> None:
    assert manifest_renewal.main(["--check"]) == 0


def test_a_change_is_named_and_then_taken_over(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["--directory", str(record)]
    page = record / "leaderboard.md"
    page.write_text(page.read_text() + "\nby hand\n")
    assert manifest_renewal.main([*asked, "--check"]) == 1
    assert "leaderboard.md" in capsys.readouterr().err
    assert manifest_renewal.main(asked) == 0
    assert capsys.readouterr().err == "leaderboard.md taken over\n"
    assert manifest_renewal.main([*asked, "--check"]) == 0


def test_what_cannot_be_read_is_said_and_nothing_taken_over(
    record: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (record / "checksums-sha256.txt").read_bytes()
    scores = record / "scores" / "pd-slit.csv"
    scores.write_text(scores.read_text() + "one cell too few\n")
    assert manifest_renewal.main(["--directory", str(record)]) == 1
    assert "pd-slit" in capsys.readouterr().err
    assert (record / "checksums-sha256.txt").read_bytes() == before
