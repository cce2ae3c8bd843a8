"""`sunatlas survey import` of others' files against the shipped tables, which stay as they are."""

from __future__ import annotations

import csv
import io
import json
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


@pytest.mark.parametrize("name", ["refs.bib", "refs.bbl", "REFS.BIB"])
def test_a_bibliography_is_known_by_its_suffix(tmp_path: Path, name: str) -> None:
    given = bibliography(tmp_path, name=name)
    shown = survey(given)
    assert shown.exit_code == 0, shown.stderr
    assert shown.stdout == survey("--bibliography", given).stdout


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


def test_entries_of_no_study_are_named_with_the_reason(tmp_path: Path) -> None:
    text = f"{BIB}@article{{Nobody1999, author={{N}}, title={{Nothing}}, year={{1999}}}}\n"
    assert (
        "left aside: Nobody1999: no study has this key\n"
        in survey(bibliography(tmp_path, text)).stdout
    )


def test_studies_that_it_does_not_name_are_listed_where_there_are_some(tmp_path: Path) -> None:
    with (DATA_DIRECTORY / "studies.csv").open(encoding="utf-8", newline="") as file:
        studies = list(csv.DictReader(file))
    whole = "".join(
        f"@misc{{{row['key']}, title={{{row['title'] or 'A title'}}}, author={{N. N.}}}}\n"
        for row in studies
    )
    assert "are not in it" not in survey(bibliography(tmp_path, whole)).stdout
    few = survey(bibliography(tmp_path)).stdout
    assert f"{len(studies) - 2} studies are not in it: {studies[0]['key']}, " in few


# ---- a table


def test_replacing_is_of_a_bibliography_alone(tmp_path: Path) -> None:
    refused = survey(table(tmp_path, "Key,Mask\n"), "--replace", CONFIRMED)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "--replace is of a bibliography, not of a table" in refused.stderr


def test_a_column_that_is_given_two_meanings_is_refused(tmp_path: Path) -> None:
    refused = survey(
        *(table(tmp_path, "Key,a=b\n"), "--map", "a=b=mask", "--map", "a=b=mask"),
        *("--map", "a=b=model"),
    )
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "--map: column 'a=b' is given both 'mask' and 'model'" in refused.stderr


def test_as_csv_it_has_a_row_a_cell_that_differs_or_is_confirmed(tmp_path: Path) -> None:
    given = table(tmp_path, "Key,Mask,Error\nAlvi2014,Slit,Alignment\n")
    shown = survey(given, "--format", "csv")
    assert shown.exit_code == 0, shown.stderr
    rows = list(csv.DictReader(io.StringIO(shown.stdout)))
    assert [(row["attribute"], row["kind"], row["row"], row["column"]) for row in rows] == [
        ("error", "new", "2", "Error"),
        ("mask", "confirmed", "2", "Mask"),
    ]
    plan = json.loads(survey(given, "--format", "json").stdout)
    assert [row["theirs"] for row in rows] == [
        "; ".join(one["theirs"]) for one in (*plan["differences"], *plan["confirmed"])
    ]


def test_guesses_and_rows_left_aside_have_tables_of_their_own(tmp_path: Path) -> None:
    text = "Key,Mask,Remarks\nAlvi2014,Singel Aperture,\nNobody1999,Slit,hello\n"
    shown = survey(table(tmp_path, text), "--map", "Remarks=-").stdout
    assert "left aside: Remarks\n" in shown
    guesses = shown.partition("Values read by similarity: check them\n")[2]
    assert "Singel Aperture" in guesses.partition("Rows left aside")[0]
    assert "no study has the key 'Nobody1999'" in guesses.partition("Rows left aside")[2]


def test_where_nothing_is_left_aside_or_guessed_no_table_says_so(tmp_path: Path) -> None:
    shown = survey(table(tmp_path, "Key,Mask\nAlvi2014,Slit\n")).stdout
    assert "1 cells that differ" in shown
    for heading in ("left aside", "Rows left aside", "read by similarity", "rest on a replaced"):
        assert heading not in shown


def test_rows_that_rest_on_a_replaced_value_are_listed(tmp_path: Path) -> None:
    """An architecture of the study is a pair of its detector and its mask."""
    shown = survey(table(tmp_path, "Key,Detector\nPost2013,CMOS\n")).stdout
    _, found, withdrawn = shown.partition("Rows of ours that rest on a replaced value")
    assert found
    assert "PDA + N-Slit" in withdrawn
    assert "PVA + Maskless" in withdrawn
