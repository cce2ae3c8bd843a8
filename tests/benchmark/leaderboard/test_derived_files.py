"""Files derived from a board: data sets of built sensors, and tables for spreadsheets."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from benchmark.leaderboard.pages import FORMATS, render, to_csv

Board = Mapping[str, Any]


@pytest.fixture
def two(published_board: Board) -> Board:
    """An idealisation and a data set of built sensors, with their first rows."""
    by_kind = {bool(one["idealisation"]): one for one in published_board["datasets"]}
    chosen = [{**by_kind[kind], "rows": by_kind[kind]["rows"][:3]} for kind in (True, False)]
    return {**published_board, "datasets": chosen, "sweeps": published_board["sweeps"][:20]}


@pytest.mark.parametrize("for_spreadsheets", [False, True])
def test_no_spreadsheet_runs_a_cell_of_a_table_that_is_made_for_it(
    two: Board, tmp_path: Path, for_spreadsheets: bool
) -> None:
    ideal, built = two["datasets"]
    formula = {**ideal["rows"][0], "reason": "=1+1", "over_bound": -1.5}
    board = {**two, "datasets": [{**ideal, "rows": [formula]}, built]}
    paths = render(board, tmp_path, for_spreadsheets=for_spreadsheets)
    assert [path.name for path in paths] == list(FORMATS)
    text = (tmp_path / "leaderboard.csv").read_text("utf-8")
    row = next(csv.DictReader(io.StringIO(text)))
    assert row["reason"] == ("'=1+1" if for_spreadsheets else "=1+1")
    assert float(row["over_bound"]) == -1.5, "a number is none that is run"
    assert (text == to_csv(board)) != for_spreadsheets
