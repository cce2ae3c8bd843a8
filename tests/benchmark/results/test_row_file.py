"""Tables, pins and manifests: what is written is read, and what contradicts itself is not."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from fake_results import pin
from pydantic import BaseModel

from benchmark.results import record_manifest
from benchmark.results.csv_tables import StoreError, number, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import pins_text, read_pins


class KeyOfGroup(BaseModel, extra="forbid"):
    key: str


TABLE: TableFile[str] = TableFile(
    "squares.csv",
    {"cell": word, "group": word, "square": number},
    KeyOfGroup,
    lambda row: str(row["cell"]),
    lambda row: str(row["group"]),
    lambda row: str(row["cell"]),
)


def rows() -> dict[str, Row]:
    return {
        cell: {"cell": cell, "group": group, "square": float(cell) ** 2, "key": f"key {group}"}
        for cell, group in (("3", "odd"), ("1", "odd"), ("2", "even"))
    }


def test_a_table_comes_back_sorted_with_what_its_groups_share(tmp_path: Path) -> None:
    assert TABLE.write(rows(), tmp_path)
    assert not TABLE.write(rows(), tmp_path)
    assert TABLE.read(tmp_path) == rows()
    assert list(TABLE.read(tmp_path)) == ["1", "2", "3"]
    (tmp_path / "squares.json").unlink()
    with pytest.raises(StoreError, match=r"line 2: 'odd' is not in squares\.json"):
        TABLE.read(tmp_path)


def test_a_cell_that_is_there_twice_is_refused_by_its_line(tmp_path: Path) -> None:
    TABLE.write(rows(), tmp_path)
    path = tmp_path / "squares.csv"
    path.write_text(path.read_text() + "2,even,5\n")
    with pytest.raises(StoreError, match=r"squares\.csv, line 5: 2 is there twice"):
        TABLE.read(tmp_path)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{", "not JSON"),
        ("[]", "Input should be a valid dictionary"),
        ('{"odd":{"clef":"x"}}', "odd/key: Field required"),
        ('{"odd":{"key":5}}', "odd/key: Input should be a valid string, got 5"),
    ],
)
def test_what_groups_share_is_refused_where_it_cannot_be_read(
    text: str, said: str, tmp_path: Path
) -> None:
    TABLE.write(rows(), tmp_path)
    (tmp_path / "squares.json").write_text(text)
    with pytest.raises(StoreError, match=rf"squares\.json\b.*{said}"):
        TABLE.read(tmp_path)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"split": "train"}, "expected a split of calibration, test, repeat, got 'train'"),
        ({"split": "repeat", "observable": 2}, "observable belongs to the split test alone"),
        ({"observable": None}, "expected at most 3 observable samples, got None"),
        ({"observable": 4}, "expected at most 3 observable samples, got 4"),
        ({"bound_deg": 0.0}, "column bound_deg: expected a number above 0, got '0'"),
        ({"bench_deg": -0.5}, "column bench_deg: expected a number of at least 0, got -0.5"),
        ({"n": None}, "expected a number in n"),
    ],
)
def test_a_pin_that_contradicts_itself_is_refused_by_its_line(
    changed: dict[str, Any], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "pins.csv"
    path.write_text(pins_text([pin(**changed)]))
    with pytest.raises(StoreError, match=f"line 2.*{said}"):
        read_pins(path)


def test_a_record_is_of_its_files_alone(tmp_path: Path) -> None:
    for name in ("a.csv", "b/c.json", "times.csv", "times_machine.json", ".d/e.csv", "f.txt"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    (tmp_path / "g.csv").mkdir()
    (tmp_path / "h.csv").symlink_to(tmp_path / "b")
    assert record_manifest.names(tmp_path) == ("a.csv", "b/c.json", "h.csv")
    assert record_manifest.changes(tmp_path) == []
    assert record_manifest.changes(tmp_path, required=True) != []


def test_nothing_is_written_to_a_record_whose_manifest_cannot_be_read(tmp_path: Path) -> None:
    assert record_manifest.write(tmp_path, {"a.csv": "x\n"}, start=True)
    assert not record_manifest.write(tmp_path, {"a.csv": "x\n"})
    (tmp_path / "checksums-sha256.txt").write_text("{")
    with pytest.raises(StoreError, match=r"checksums-sha256.txt, line 1: expected 64"):
        record_manifest.write(tmp_path, {"a.csv": "y\n"})
    assert (tmp_path / "a.csv").read_text() == "x\n"
