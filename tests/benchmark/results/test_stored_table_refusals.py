"""Cells, lines and files of tables that cannot be read are refused by file, line and column."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmark.results.csv_tables import (
    Reader,
    StoreError,
    above_zero,
    count,
    number,
    one_of,
    parse_whole,
    read_csv,
    share,
    size,
    word,
)
from benchmark.results.store import Store


@pytest.mark.parametrize(
    ("reader", "text", "said"),
    [
        (number, "x", "'x'"),
        (size, "-0.5", "a number of at least 0, got -0.5"),
        (above_zero, "0", "a number above 0, got '0'"),
        (above_zero, "-1e-9", "a number above 0, got '-1e-9'"),
        (share, "1.5", "a number from 0 to 1, got 1.5"),
        (share, "-0.1", "a number from 0 to 1, got -0.1"),
        (parse_whole, "1.0", "'1.0'"),
        (count, "-1", "a number of at least 0, got -1"),
        (one_of("ok", "refused"), "good", "one of ok, refused, got 'good'"),
        (word, "", "a word, got an empty cell"),
    ],
)
def test_a_cell_outside_its_column_is_refused_with_what_was_expected(
    reader: Reader, text: str, said: str, tmp_path: Path
) -> None:
    path = tmp_path / "t.csv"
    path.write_text(f"a,b\n1,{text}\n")
    with pytest.raises(StoreError, match=rf"t\.csv, line 2, column b: .*{said}"):
        read_csv(path, {"a": number, "b": reader})


@pytest.mark.parametrize(
    ("reader", "text", "value"),
    [
        (above_zero, "1e-9", 1e-9),
        (size, "0", 0.0),
        (share, "1", 1.0),
        (count, "0", 0),
        (above_zero, "", None),
        (size, "", None),
        (share, "", None),
        (count, "", None),
    ],
)
def test_the_ends_of_a_range_belong_to_it_and_an_empty_cell_is_none(
    reader: Reader, text: str, value: float | None
) -> None:
    assert reader(text) == value


def test_a_file_where_the_tables_of_scores_should_be_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path)
    store.scores_directory.touch()
    with pytest.raises(StoreError, match="scores: expected a directory of tables"):
        store.scores()
