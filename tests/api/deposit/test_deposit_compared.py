"""A bundle is compared file by file with the one that is built here: where it differs is said."""

from __future__ import annotations

import json
import shutil
import sqlite3
from collections.abc import Callable, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from pyarrow import parquet

from api.deposit import against_record
from api.deposit.against_record import differences
from api.deposit.database import DATABASE
from api.deposit.package import DESCRIPTOR
from api.metadata.identity import identity
from tests.api.deposit.test_deposit_forms import PARQUET

Problems = dict[str, str]


@pytest.fixture
def small(small: Path) -> Path:
    package = json.loads((small / DESCRIPTOR).read_text("utf-8"))
    package["version"] = identity().version
    (small / DESCRIPTOR).write_text(json.dumps(package))
    return small


@pytest.fixture
def compare(
    small: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Callable[[Callable[[Path], object]], Problems]:
    """Compare a bundle, after a change, with what it was: all that the record makes here."""
    before = Path(shutil.copytree(small, tmp_path / "before"))
    for name in [PARQUET, DATABASE]:
        (before / name).unlink()

    def fill(made: Path, *_: Any, other_forms: Callable[[Path, Mapping[str, Any]], None]) -> None:
        shutil.copytree(before, made, dirs_exist_ok=True)
        other_forms(made, json.loads((made / DESCRIPTOR).read_text("utf-8")))

    monkeypatch.setattr(against_record, "fill", fill)
    monkeypatch.setattr(against_record, "write_code_as_in", lambda _bundle, _made: None)
    monkeypatch.setattr(against_record, "measured_tables", lambda _published: [])

    def compared(change: Callable[[Path], object]) -> Problems:
        change(small)
        return dict(differences(small, frames=()))

    return compared


def repacked(bundle: Path) -> None:
    """Hold the same tables, as another library might have written them."""
    for path in (bundle / "parquet").iterdir():
        parquet.write_table(parquet.read_table(path), path, compression="gzip")
    with closing(sqlite3.connect(bundle / DATABASE)) as base:
        base.execute("PRAGMA page_size = 8192")
        base.execute("VACUUM")


def edited(name: str, edit: Callable[[str], str]) -> Callable[[Path], object]:
    return lambda bundle: (bundle / name).write_text(edit((bundle / name).read_text("utf-8")))


def other_values(bundle: Path) -> None:
    table = parquet.read_table(bundle / PARQUET)
    parquet.write_table(table.slice(0, 0), bundle / PARQUET)
    with closing(sqlite3.connect(bundle / DATABASE)) as base:
        base.execute("DELETE FROM one")
        base.commit()


FORMS = "holds other tables than the CSV of this bundle"
HERE = "built of facts and record here"


@pytest.mark.parametrize(
    ("change", "problems"),
    [
        (lambda _bundle: None, {}),
        (repacked, {}),
        (other_values, {PARQUET: FORMS, DATABASE: FORMS}),
        (lambda bundle: (bundle / DATABASE).unlink(), {DATABASE: "missing"}),
        (
            lambda bundle: (bundle / "more.txt").write_text(""),
            {"more.txt": "no file of this bundle"},
        ),
        (
            edited("README.md", lambda _: "# other\n"),
            {"README.md": f"row 1 is '# other'; {HERE} it is '# read me'"},
        ),
        (
            edited("README.md", lambda text: text + "more"),
            {"README.md": f"row 2 is 'more'; {HERE} it is ''"},
        ),
    ],
)
def test_each_file_that_differs_is_named_with_the_place(
    compare: Callable[[Callable[[Path], object]], Problems],
    change: Callable[[Path], object],
    problems: Problems,
) -> None:
    found = compare(change)
    assert found.keys() == problems.keys()
    for name, text in problems.items():
        assert found[name].startswith(text), found[name]
