"""An answer holds until something it depends on changes."""

import os

import pytest

from benchmark.results import unchanged
from benchmark.results.unchanged import KeptAnswer, fingerprint


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A record and a tree of sources beside which nothing else counts."""
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path / "cache"))
    monkeypatch.setattr(unchanged, "_ROOT", tmp_path / "tree")
    for folder in ("tree/benchmark/results", "record/scores", "record/.sunatlas/stages/ab"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "tree" / "benchmark" / "results" / "m.py").write_text("x = 1\n")
    (tmp_path / "record" / "scores" / "d.csv").write_text("a,b\n")
    return tmp_path


def known(place, what="plan"):
    return KeptAnswer(what, [place / "record"]).recall()


def test_an_answer_is_known_until_a_source_or_the_record_changes(place):
    assert known(place) is None
    KeptAnswer("plan", [place / "record"]).keep(7)
    assert known(place) == 7
    assert known(place, "another question") is None
    assert KeptAnswer("plan", [place]).recall() is None
    for name in ("tree/benchmark/results/m.py", "record/scores/d.csv", "record/.sunatlas/j.jsonl"):
        KeptAnswer("plan", [place / "record"]).keep(7)
        with (place / name).open("a") as file:
            file.write("more\n")
        assert known(place) is None, name
    KeptAnswer("plan", [place / "record"]).keep(7)
    os.utime(place / "record" / "scores" / "d.csv", (1, 1))
    assert known(place) is None


def test_what_can_be_made_again_does_not_count(place):
    before = fingerprint([place / "record"])
    (place / "record" / ".sunatlas" / "stages" / "ab" / "cd.1").write_text("x")
    (place / "record" / "definitions").write_text("x")
    (place / "record" / ".sunatlas" / "store.lock").write_text("x")
    assert fingerprint([place / "record"]) == before


def test_an_answer_made_while_something_changed_is_not_taken(place):
    """It may be of either state."""
    asked = KeptAnswer("plan", [place / "record"])
    (place / "record" / "scores" / "d.csv").write_text("a,b,c\n")
    asked.keep(7)
    assert known(place) is None


def test_a_damaged_answer_is_none(place):
    KeptAnswer("plan", [place / "record"]).keep(7)
    (file,) = (place / "cache" / "unchanged").iterdir()
    whole = file.read_bytes()
    for damaged in (b"", whole[:-1], b"x" * 40):
        file.write_bytes(damaged)
        assert known(place) is None
    file.write_bytes(whole)
    assert known(place) == 7
