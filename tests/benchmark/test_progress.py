"""How far something is, where there is no terminal: seldom, and with the time that is left."""

from __future__ import annotations

import re
import sys

import pytest

from benchmark import processes
from benchmark.progress import console_progress, lines, time_left


@pytest.mark.parametrize(
    ("each_s", "expected"),
    [
        (
            1.0,
            [
                ["15", "40", "25 s", "14"],
                ["30", "40", "10 s", "29"],
            ],
        ),
        (
            60.0,
            [
                ["1", "4", "3 min", "0"],
                ["2", "4", "2 min", "1"],
                ["3", "4", "60 s", "2"],
            ],
        ),
        (0.1, []),
    ],
)
def test_lines_are_seldom_and_say_the_time_that_is_left(each_s, expected):
    total = {1.0: 40, 60.0: 4, 0.1: 100}[each_s]
    now = [0.0]
    said: list[str] = []
    report = lines("building", said.append, clock=lambda: now[0])
    for done in range(total + 1):
        report(done, total, f"data set {done - 1}")
        now[0] += each_s
    assert all(line.startswith("building: ") for line in said)
    assert [re.findall(r"\d+(?: min| s)?\b", line) for line in said] == expected


def test_nothing_is_said_of_what_has_no_parts_or_is_done():
    now = [0.0]
    said: list[str] = []
    report = lines("building", said.append, clock=lambda: now[0])
    for done, total in ((0, 0), (0, 3), (3, 3), (4, 3)):
        now[0] += 100.0
        report(done, total, "")
    assert said == []


def test_a_quiet_command_shows_nothing_even_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with console_progress("building", quiet=True) as report:
        report(1, 2, "pd-slit")
    assert capsys.readouterr().err == ""


def test_a_terminal_has_a_bar_with_the_time_that_is_left(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with console_progress("building") as report:
        report(1, 2, "pd-slit")
    shown = capsys.readouterr().err
    assert "1/2" in shown
    assert "left" in shown


def test_a_signal_that_was_lost_ends_what_is_done_at_the_next_step(monkeypatch):
    with console_progress("building", quiet=True) as report:
        report(1, 3, "")
        monkeypatch.setattr(processes, "_told", [15])
        with pytest.raises(KeyboardInterrupt):
            report(2, 3, "")


def test_the_time_that_is_left_goes_by_what_is_done():
    assert time_left(30.0, 3, 4) == "10 s"
    assert time_left(40.0, 1, 4) == "2 min"
    assert time_left(30.0, 0, 4) == time_left(30.0, 4, 4) == time_left(30.0, 0, 0) == ""
