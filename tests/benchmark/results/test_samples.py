"""Errors sample by sample: what is written is read back, by us and by pandas."""

import math
from contextlib import suppress
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from pyarrow import parquet

from benchmark.contract import Cell
from benchmark.results import record_manifest, samples
from benchmark.results.csv_tables import StoreError
from benchmark.results.samples import CellErrors, Directions, SampleErrors

SUN = np.array([[0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [0.0, -0.8, 0.6], [1.0, 0.0, 0.0]])
CELLS = [Cell("lamp", "nominal", *names) for names in (("b", "y", 0), ("a", "x", 3), ("a", "x", 0))]
ERRORS = np.array([0.0123456, math.nan, 180.0, math.nan])
FOUND = np.array([True, True, True, False])


def everything(_cell: Cell) -> bool:
    return True


def collected(*cells: Cell, factor: float = 1.0) -> SampleErrors:
    found = SampleErrors()
    found.directions["lamp"] = Directions(
        SUN, np.array([True, True, True, False]), np.array([0.01, 0.02, 0.03, math.inf])
    )
    for cell in cells or CELLS:
        found.add(cell, ERRORS * factor, FOUND)
    return found


@pytest.fixture
def record(tmp_path: Path) -> Path:
    record_manifest.write(tmp_path, {"pins.csv": "dataset\n"}, start=True)
    collected().write(tmp_path, everything)
    return tmp_path


def test_pandas_reads_rows_sorted_with_errors_and_outcomes(record: Path) -> None:
    found = pd.read_parquet(record / "samples" / "lamp.parquet")
    assert list(found.columns) == list(samples.COLUMNS)
    cells = found[["extractor", "model", "unit"]].drop_duplicates().to_numpy().tolist()
    assert cells == [["a", "x", 0], ["a", "x", 3], ["b", "y", 0]]
    first = found[:4]
    assert first["sample"].tolist() == [0, 1, 2, 3]
    assert first["outcome"].tolist() == [0, 2, 0, 1]
    np.testing.assert_allclose(first["error_deg"], ERRORS, rtol=1 / 2048)


@pytest.mark.parametrize("size", [1e-9, 3e-5, 0.0021, 0.5, 7.3, 179.99])
def test_an_error_is_kept_to_a_part_in_two_thousand(size: float) -> None:
    values = size * np.random.default_rng(0).uniform(0.1, 1.0, 500)
    kept = CellErrors.of(values, np.ones(500, bool)).error_deg
    assert float(np.max(np.abs(kept / values - 1.0))) <= 1 / 2048 + 1e-6


def test_two_records_of_the_same_numbers_have_the_same_bytes(tmp_path: Path) -> None:
    data = []
    for folder, cells in (("one", CELLS), ("two", CELLS[::-1])):
        collected(*cells).write(tmp_path / folder, everything)
        data.append(
            [p.read_bytes() for p in sorted((tmp_path / folder / "samples").glob("*.parquet"))]
        )
    assert len(data[0]) == 2
    assert data[0] == data[1]


def test_cells_not_measured_now_stay_and_unwanted_ones_go(record: Path) -> None:
    before = samples.read_samples("lamp", record)
    now = collected(CELLS[0], factor=0.5)
    assert now.write(record, lambda cell: cell != CELLS[2])
    found = samples.read_samples("lamp", record)
    assert found[["extractor", "unit"]].drop_duplicates().to_numpy().tolist() == [
        ["a", 3],
        ["b", 0],
    ]
    assert found[:4]["error_deg"].equals(before[:4]["error_deg"])
    np.testing.assert_allclose(found["error_deg"][4:6], ERRORS[:2] * 0.5, rtol=1 / 2048)
    assert not now.write(record, lambda cell: cell != CELLS[2])
    assert SampleErrors().write(record, lambda _cell: False)
    assert samples.datasets(record) == ()
    assert not record_manifest.changes(record, required=True)


def test_the_journal_brings_errors_and_directions_back() -> None:
    errors = CellErrors.of(ERRORS, FOUND)
    again = CellErrors.read(errors.to_texts())
    np.testing.assert_array_equal(again.error_deg, errors.error_deg)
    np.testing.assert_array_equal(again.outcome, errors.outcome)
    directions = collected().directions["lamp"]
    known = Directions.read(directions.to_texts())
    for name in ("sun", "observable", "bound_deg"):
        np.testing.assert_array_equal(getattr(known, name), getattr(directions, name))


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9, 0.99])
def test_a_truncated_file_is_refused(record: Path, share: float) -> None:
    path = record / "samples" / "lamp.parquet"
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    with pytest.raises(StoreError, match=r"lamp\.parquet: not a whole Parquet file"):
        samples.read_samples("lamp", record)


def test_no_changed_byte_passes_unseen_or_crashes(record: Path) -> None:
    path = record / "samples" / "lamp.parquet"
    data, before = path.read_bytes(), samples.read_samples("lamp", record)
    for place in range(0, len(data), 3):
        path.write_bytes(data[:place] + bytes([data[place] ^ 0x55]) + data[place + 1 :])
        with suppress(StoreError):
            assert samples.read_samples("lamp", record).equals(before)


@pytest.mark.parametrize(
    ("column", "kind", "said"),
    [
        ("error_deg", pa.float64(), r"error_deg \(double\)"),
        ("unit", pa.int64(), r"unit \(int64\)"),
    ],
)
def test_other_types_are_refused(record: Path, column: str, kind: pa.DataType, said: str) -> None:
    path = record / "samples" / "lamp.parquet"
    table = parquet.read_table(path)
    place = table.schema.get_field_index(column)
    parquet.write_table(table.set_column(place, column, table[column].cast(kind)), path)
    with pytest.raises(StoreError, match=said):
        samples.read_samples("lamp", record)


@pytest.mark.parametrize(
    ("error", "found"),
    [([0.1, 0.2], [True]), ([[0.1]], [[True]]), ([], []), ([-0.1], [True]), ([math.inf], [True])],
)
def test_errors_that_are_none_are_refused(error: list[float], found: list[bool]) -> None:
    with pytest.raises(ValueError, match="error_deg"):
        CellErrors.of(error, found)


def test_only_the_first_condition_is_kept() -> None:
    with pytest.raises(ValueError, match="nominal"):
        SampleErrors().add(Cell("lamp", "hot", "a", "x"), [0.1], [True])
