"""Cells drawn from a record and measured again: what differs is named, what may is counted."""

from __future__ import annotations

import csv
from pathlib import Path

import fake_atlas
import fake_plan
import pytest

from benchmark.contract import Cell
from benchmark.plan.combinations import cells
from benchmark.progress import silent
from benchmark.results.store import Store
from benchmark.running.experiment import draw_cells
from benchmark.running.runner import run
from benchmark.suites.verification import VerificationResult, verify

PARTS = fake_plan.parts(fake_atlas.LeastSquares, fake_atlas.Choosy)
CELLS = [Cell(f"d{n % 7}", "c", f"e{n % 11}", f"m{n}") for n in range(200)]


@pytest.fixture
def record(tmp_path: Path) -> Store:
    store = Store(tmp_path / "record")
    wanted = cells(parts=PARTS)
    other = [Cell(c.dataset, c.condition, c.extractor, c.model, 1) for c in wanted]
    run([*wanted, *other], store, progress=silent, parts=PARTS)
    return store


def verified(record: Store, wanted: list[Cell] | None = None) -> VerificationResult:
    return verify(wanted or list(record.scores()), record, 1, silent, parts=PARTS)


def changed(record: Store, column: str, factor: float) -> Cell:
    """Change the first number of a column by a factor; return its cell."""
    (path,) = record.scores_directory.glob("*.csv")
    with path.open() as file:
        rows = list(csv.DictReader(file))
    row = next(row for row in rows if row[column])
    row[column] = repr(float(row[column]) * factor)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(row), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    unit = int(row["unit"])
    return Cell(path.stem, row["condition"], row["extractor"], row["model"], unit)


def contents(store: Store) -> dict[Path, bytes]:
    return {path: path.read_bytes() for path in store.directory.rglob("*") if path.is_file()}


def test_a_record_of_this_code_is_alike_to_the_last_digit(record: Store) -> None:
    before = contents(record)
    found = verified(record)
    assert (len(found.cells), found.alike, found.differences) == (16, 16, ())
    assert contents(record) == before


@pytest.mark.parametrize(
    ("column", "factor"),
    [("p95_deg", 1.01), ("p95_deg", 0.5), ("availability", 0.5)],  # of shares, many samples
)
def test_a_number_that_does_not_hold_is_named_with_its_cell(
    record: Store, column: str, factor: float
) -> None:
    cell = changed(record, column, factor)
    found = verified(record)
    (difference,) = found.differences
    assert difference.cell == f"{cell}/{column}"
    assert difference.file == f"scores/{cell.dataset}.csv"
    assert found.alike == 15
    others = [other for other in record.scores() if other != cell]
    assert verified(record, others).differences == ()


def test_what_another_processor_may_change_is_counted_and_no_difference(record: Store) -> None:
    """A hundred-thousandth is what `leaderboard --check` allows; digit for digit it is unlike."""
    changed(record, "p95_deg", 1.00001)
    found = verified(record)
    assert (found.alike, found.differences) == (15, ())


def test_a_cell_that_the_record_lacks_is_a_difference(record: Store, tmp_path: Path) -> None:
    (cell, *_) = record.scores()
    found = verify([cell], Store(tmp_path / "empty"), 1, silent, parts=PARTS)
    (difference,) = found.differences
    assert (difference.cell, difference.committed) == (f"{cell}/row", "absent")
    assert found.alike == 0


def test_a_seed_draws_the_same_cells_whatever_else_there_is() -> None:
    ten = draw_cells(CELLS, 10, 1)
    assert ten == sorted(set(ten)) == draw_cells(reversed(CELLS), 10, 1)
    assert set(draw_cells(CELLS, 5, 1)) < set(ten)
    rest = [cell for cell in CELLS if cell.dataset != "d3"]
    assert set(draw_cells(rest, 10, 1)) >= {cell for cell in ten if cell.dataset != "d3"}
    assert draw_cells(CELLS, 1000, 1) == sorted(CELLS)
    assert draw_cells(CELLS, 10, 2) != ten
    with pytest.raises(ValueError, match="at least 1; got 0"):
        draw_cells(CELLS, 0, 1)


def test_every_cell_is_drawn_as_often_as_any_other() -> None:
    """Over 400 seeds a cell of 200 is drawn 20 +- 4.4 times of 10: none beyond five of those."""
    counts = dict.fromkeys(CELLS, 0)
    for seed in range(400):
        for cell in draw_cells(CELLS, 10, seed):
            counts[cell] += 1
    assert sum(counts.values()) == 4000
    assert max(abs(count - 20) for count in counts.values()) < 5 * 4.4
