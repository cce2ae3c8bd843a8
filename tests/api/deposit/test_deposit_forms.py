"""What can be seen in a bundle alone: forms of its tables."""

from __future__ import annotations

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.deposit.crate import CRATE
from api.deposit.database import DATABASE
from api.deposit.forms import write_other_forms
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import UNSEEN, verify
from files.checksums import sha256
from tests.api.deposit.test_deposit_verification import agree, change

TABLE, PARQUET = "benchmark/one.csv", "parquet/one.parquet"


def signed_anew(bundle: Path) -> None:
    """Let descriptor, crate and checksums agree with whatever the files hold now."""
    package = json.loads((bundle / DESCRIPTOR).read_text("utf-8"))
    for resource in package["resources"]:
        path = bundle / resource["path"]
        resource["bytes"], resource["hash"] = path.stat().st_size, f"sha256:{sha256(path)}"
    (bundle / DESCRIPTOR).write_text(json.dumps(package))
    agree(bundle)


def found(bundle: Path) -> dict[str, str]:
    signed_anew(bundle)
    return dict(verify(bundle))


def test_a_table_changed_in_csv_alone_is_seen_in_the_other_forms(small):
    (small / TABLE).write_text("name\nb\n")
    problems = found(small)
    assert problems.keys() == {PARQUET, DATABASE}
    assert set(problems.values()) == {"holds other tables than the CSV of this bundle"}


def test_a_number_changed_in_every_form_is_not_seen_and_this_is_said(small):
    (small / TABLE).write_text("name\nb\n")
    (small / DATABASE).unlink()
    write_other_forms(small, json.loads((small / DESCRIPTOR).read_text("utf-8")))
    assert found(small) == {}
    shown = CliRunner().invoke(app, ["deposit", "verify", "--alone", str(small)])
    assert shown.exit_code == 0
    assert UNSEEN in shown.stderr


@pytest.mark.parametrize("name", [PARQUET, DATABASE])
@pytest.mark.parametrize("share", [0.0, 0.5])
def test_a_form_that_is_cut_short_is_seen(small, name, share):
    data = (small / name).read_bytes()
    (small / name).write_bytes(data[: int(share * len(data))])
    assert found(small).keys() == {name}


def test_a_form_that_is_missing_or_of_no_table_is_seen(small):
    shutil.copy(small / PARQUET, small / "parquet" / "two.parquet")
    (small / PARQUET).unlink()
    (small / DATABASE).unlink()
    crate = json.loads((small / CRATE).read_text("utf-8"))
    gone = {PARQUET, DATABASE}
    crate["@graph"] = [entity for entity in crate["@graph"] if entity["@id"] not in gone]
    other = next(entity for entity in crate["@graph"] if entity["@id"] == "README.md")
    crate["@graph"].append({**other, "@id": "parquet/two.parquet"})
    (small / CRATE).write_text(json.dumps(crate))
    problems = found(small)
    assert problems == {
        PARQUET: "missing",
        DATABASE: "missing",
        "parquet/two.parquet": "no table of this bundle",
    }


@pytest.mark.parametrize(
    "statement",
    [
        "CREATE VIEW more AS SELECT 1",
        "CREATE TRIGGER t AFTER INSERT ON one BEGIN DELETE FROM one; END",
        "UPDATE one SET name = 'b'",
        "UPDATE columns_of_the_atlas SET description = 'another'",
    ],
)
def test_a_database_that_holds_anything_else_is_seen(small, statement):
    with closing(sqlite3.connect(small / DATABASE)) as base:
        base.execute(statement)
        base.commit()
    assert found(small).keys() == {DATABASE}


@pytest.mark.parametrize("version", ["../../x", "", None, "1 2", "0.1.0\x1b[2J"])
def test_a_version_that_is_none_is_seen(small, version):
    change(small, lambda package: package.__setitem__("version", version))
    assert {name for name, _ in verify(small)} == {DESCRIPTOR}
