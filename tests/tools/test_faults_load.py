"""The load's report tells of what it is for."""

from __future__ import annotations

import os
import random
import re

import numpy as np
import pytest

from tools.faults.load.driving import Answer, Load, memory
from tools.faults.load.report import failures, report
from tools.faults.load.requests import KINDS, Names, drawn


def load(memory: float = 1.0, status: int = 200, slow: int = 0) -> Load:
    """An hour of a thousand answers, the last of another status, some of a hundredfold time."""
    answers = [
        Answer("a study", "/v1/studies/x", 3.6 * n, 0.2 if n < slow else 0.002, 0.0, 200)
        for n in range(999)
    ]
    answers.append(Answer("a study", "/v1/studies/y", 3600.0, 0.002, 0.0, status))
    seen = [(30.0 * n, int(2e8 * (memory if n > 100 else 1.0))) for n in range(120)]
    return Load(20.0, 3600.0, answers, seen, seen)


def test_a_good_hour_has_no_failures() -> None:
    assert failures(load()) == []
    assert "100.00% below ten times" in report(load())
    assert "it changed by +0.00%" in report(load())


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"status": 500}, r"^1 .* 500 /v1/studies/y$"),
        ({"status": 0}, r"^1 .* 0 /v1/studies/y$"),
        ({"slow": 20}, r"^98\.00% .*\b10 medians\b.* 99%$"),
        ({"memory": 1.1}, r"^memory .* 10\.0% "),
    ],
)
def test_each_fault_is_told(changes: dict[str, float], said: str) -> None:
    (fault,) = failures(load(**changes))
    assert re.search(said, fault)


def test_pages_of_files_are_no_memory_of_its_own() -> None:
    own, resident = memory(os.getpid())
    assert 0 < own < resident
    held = np.ones(2**24)
    assert memory(os.getpid())[0] - own > 0.9 * held.nbytes


def test_every_kind_is_drawn_and_a_seed_draws_the_same_again() -> None:
    known = Names(("A 1",), ("set",), ("C01",), ("PD",), ("Slit",), ("/",))
    draw, again = random.Random(7), random.Random(7)
    found = [drawn(draw, known) for _ in range(500)]
    assert {one.kind for one in found} == set(KINDS)
    assert found == [drawn(again, known) for _ in range(500)]
