"""`sunatlas survey import` of others' files against the shipped tables, which stay as they are."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from survey_data.descriptor import DATA_DIRECTORY

#: Our identity of this study was confirmed by a page; of the next nothing is known.
CONFIRMED, UNKNOWN = "Liebe2001", "Fan2017"
BIB = f"""\
@article{{{CONFIRMED}, author={{C. Liebe}}, title={{Another title}}, year={{2001}}}}
@article{{{UNKNOWN}, author={{Q. Fan}}, title={{A title}}, year={{2017}}}}
"""


def survey(*arguments: object) -> Any:
    call = ["survey", "import", *map(str, arguments)]
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, call, catch_exceptions=False)


@pytest.fixture(autouse=True)
def _shipped_tables_stay() -> Iterator[None]:
    before = {path: path.read_bytes() for path in DATA_DIRECTORY.rglob("*.csv")}
    yield
    assert {path: path.read_bytes() for path in DATA_DIRECTORY.rglob("*.csv")} == before


def table(folder: Path, text: str) -> Path:
    path = folder / "theirs.csv"
    path.write_text(text, "utf-8")
    return path


def bibliography(folder: Path, text: str = BIB, name: str = "refs.bib") -> Path:
    path = folder / name
    path.write_text(text, "utf-8")
    return path


# ---- a bibliography


def test_a_confirmed_study_said_otherwise_is_named_and_replaced_only_where_asked(
    tmp_path: Path,
) -> None:
    given = bibliography(tmp_path)
    kept = survey(given).stdout
    assert f"confirmed and said otherwise: {CONFIRMED}; --replace KEY" in kept
    assert "--apply writes 3 cells and 1 identity." in kept
    replaced = survey(given, "--replace", CONFIRMED).stdout
    assert "confirmed and said otherwise" not in replaced
    assert "--apply writes 6 cells and 2 identities." in replaced


# ---- a table


def test_a_column_that_is_given_two_meanings_is_refused(tmp_path: Path) -> None:
    refused = survey(
        *(table(tmp_path, "Key,a=b\n"), "--map", "a=b=mask", "--map", "a=b=mask"),
        *("--map", "a=b=model"),
    )
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "--map: column 'a=b' is given both 'mask' and 'model'" in refused.stderr


def test_rows_and_columns_left_aside_are_named(tmp_path: Path) -> None:
    text = "Key,Mask,Remarks\nAlvi2014,Single Aperture,\nNobody1999,Slit,hello\n"
    shown = survey(table(tmp_path, text), "--map", "Remarks=-").stdout
    assert "left aside: Remarks\n" in shown
    assert "no study has the key 'Nobody1999'" in shown.partition("Rows left aside")[2]
