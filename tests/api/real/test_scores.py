"""Scores on real readings are those that the fetched files give; they name licence and author."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import typer

from api.cli.commands.dataset import app
from api.real.scores import kept, measured
from api.real.sets import SETS

SHARED = Path(__file__).parents[4] / "shared" / "real"


@pytest.mark.parametrize("name", SETS)
def test_every_set_has_scores_the_best_first(name):
    rows = kept(name)
    errors = [row["rms_deg"] for row in rows]
    assert len(rows) >= 4
    assert errors == sorted(errors)
    assert all(row["worst_run_deg"] >= row["rms_deg"] > 0 for row in rows)


@pytest.mark.slow
@pytest.mark.skipif(not SHARED.is_dir(), reason="no ../shared beside this checkout")
@pytest.mark.parametrize("name", SETS)
def test_the_files_give_the_scores_that_are_kept(name):
    assert measured(SETS[name], SHARED / name) == kept(name)


def test_the_command_shows_them_beside_a_standard_data_set(capsys):
    command = typer.main.get_command(app)
    command.main(["fetch", "cubesatbox", "--scores", "--format", "json"], standalone_mode=False)
    told = capsys.readouterr()
    rows = json.loads(told.out)
    rows = rows if isinstance(rows, list) else next(v for v in rows.values() if isinstance(v, list))
    assert [row["model"] for row in rows] == [row["model"] for row in kept("cubesatbox")]
    assert all(row["dataset"] and row["dataset_own_error_deg"] > 0 for row in rows)
    assert "licence: MIT" in told.err
    assert "Benjamin Jensen" in told.err
