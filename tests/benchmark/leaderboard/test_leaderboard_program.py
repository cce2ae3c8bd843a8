"""The program that brings a record up to date in a process of its own."""

from __future__ import annotations

import pytest

from benchmark.leaderboard import __main__ as program


def test_directory_and_workers_are_handed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    called: list[tuple[str, int]] = []
    monkeypatch.setattr(program, "update", lambda *given: called.append(given))
    monkeypatch.setattr("sys.argv", ["benchmark.leaderboard", "record", "3"])
    assert program.main() == 0
    assert called == [("record", 3)]
