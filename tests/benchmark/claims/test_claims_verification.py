"""Outcomes that cannot be of their plan, and forged ones that can, are told."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from benchmark.claims import run
from benchmark.claims.ledger import LedgerError, ledger
from benchmark.claims.outcomes import PUBLISHED, read
from benchmark.claims.rules import FIRST_TRIAL, claims
from benchmark.claims.verification import contradictions, differences, drawn

QUICK = "C05"


@pytest.fixture
def directory(tmp_path: Path) -> Path:
    shutil.copy(PUBLISHED / f"{QUICK}.json", tmp_path)
    return tmp_path


def change(directory: Path, edit: Callable[[Any], object]) -> None:
    path = directory / f"{QUICK}.json"
    document = json.loads(path.read_text())
    edit(document)
    path.write_text(json.dumps(document))


def first(document: Any) -> list[float]:
    values: list[float] = next(iter(document["values"].values()))
    return values


def test_no_published_outcome_contradicts_its_plan() -> None:
    found = {name: list(contradictions(claims()[name], one)) for name, one in read().items()}
    assert {name for name, told in found.items() if told} == set()
    assert len(found) >= 50


@pytest.mark.parametrize(
    ("edit", "said"),
    [
        (lambda d: first(d).pop(), r"values, .*: expected [0-9]+ trials, got"),
        (lambda d: d["values"].update(other=[1.0]), "values: expected those of .*'other'"),
        (lambda d: d["values"].clear(), "values: expected those of"),
        (
            lambda d: next(iter(d["lines"].values()))["median"].__setitem__(0, 1e9),
            "point 1: 1000000000.0 is not between",
        ),
    ],
)
def test_what_cannot_be_is_said_by_check_and_ledger(
    directory: Path, edit: Callable[[Any], object], said: str
) -> None:
    assert QUICK not in run.due(directory)
    change(directory, edit)
    with pytest.raises(LedgerError, match=rf"{QUICK}.json: .*{said}.*measure it again"):
        ledger(directory)
    assert run.due(directory)[QUICK]


def test_a_forged_number_is_found_by_its_trial_made_again(
    directory: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    place = (QUICK, FIRST_TRIAL + 1)
    assert list(differences([place], directory)) == []
    change(directory, lambda d: first(d).__setitem__(1, first(d)[1] * 1.001))
    ((file, text),) = differences([place], directory)
    assert file == f"{QUICK}.json"
    assert text.startswith(f"trial {FIRST_TRIAL + 1}: values, ")
    assert list(differences([(QUICK, FIRST_TRIAL)], directory)) == []
    every = claims()[QUICK].trials
    assert run.main(["--directory", str(directory), "--again", str(every), "--seed", "3"]) == 1
    assert f"{QUICK}.json: trial {FIRST_TRIAL + 1}: values" in capsys.readouterr().out


def test_lots_are_of_seed_and_name(directory: Path) -> None:
    assert drawn(3, 1, directory) == drawn(3, 1, directory)
    assert len(drawn(99, 1, directory)) == claims()[QUICK].trials
    assert set(drawn(3, 1)) <= set(drawn(9, 1))
