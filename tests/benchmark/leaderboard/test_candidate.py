"""One algorithm on a board: what is refused, what is measured, and that the others stay."""

from __future__ import annotations

import html
from pathlib import Path

import pytest

from benchmark.leaderboard.candidate import rank
from benchmark.leaderboard.pages import to_html
from benchmark.results.store import Store

CUBE = "pd-maskless-cube"


@pytest.mark.slow
def test_a_model_of_the_record_has_its_published_numbers_among_all_others(tmp_path: Path) -> None:
    record = Store()
    found = rank("basic", CUBE, record, Store(tmp_path / "work"))
    published = {
        (row["extractor"], row["model"]): row
        for row in record.rows()
        if row["dataset"] == CUBE and row["condition"] == "nominal"
    }
    board = {(row["extractor"], row["model"]): row for row in found.rows}
    assert board.keys() == published.keys()
    assert {pair: row["rms_deg"] for pair, row in board.items()} == {
        pair: row["rms_deg"] for pair, row in published.items()
    }
    assert {model for _, model in found.pipelines} >= {"basic"}
    page = to_html(found.board, marked=found.pipelines, note=found.scope)
    assert page.count('class="marked"') == sum(found.has(row) for row in found.rows) > 0
    assert found.scope in html.unescape(page)
