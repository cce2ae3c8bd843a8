"""How far something is, where there is no terminal: seldom, and with the time that is left."""

from __future__ import annotations

import re
import sys

import pytest

from benchmark import processes
from benchmark.progress import console_progress, lines


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


def test_a_quiet_command_shows_nothing_even_on_a_terminal(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    with console_progress("building", quiet=True) as report:
        report(1, 2, "pd-slit")
    assert capsys.readouterr().err == ""


def test_a_signal_that_was_lost_ends_what_is_done_at_the_next_step(monkeypatch):
    with console_progress("building", quiet=True) as report:
        report(1, 3, "")
        monkeypatch.setattr(processes, "_told", [15])
        with pytest.raises(KeyboardInterrupt):
            report(2, 3, "")
