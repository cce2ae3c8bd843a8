"""What can be seen in a bundle alone: forms of its tables, their ends, its terms."""

from __future__ import annotations

import json
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pyarrow as pa
import pytest
from pyarrow import parquet
from typer.testing import CliRunner

from api.cli.command_line import app
from api.deposit.crate import CRATE
from api.deposit.database import DATABASE
from api.deposit.forms import write_other_forms
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import UNSEEN, verify
from files.checksums import sha256
from tests.api.deposit import small_bundle
from tests.api.deposit.test_deposit_verification import agree, change

TABLE, PARQUET = "benchmark/one.csv", "parquet/one.parquet"


@pytest.fixture
def small(tmp_path):
    return small_bundle.make(tmp_path / "bundle")


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
@pytest.mark.parametrize("share", [0.0, 0.5, 0.999])
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


def test_a_database_that_another_release_wrote_holds_the_same(small):
    with closing(sqlite3.connect(small / DATABASE)) as base:
        base.execute("PRAGMA page_size = 1024")
        base.execute("VACUUM")
    assert found(small) == {}


def test_a_parquet_that_another_release_wrote_holds_the_same(small):
    table = parquet.read_table(small / PARQUET)
    parquet.write_table(table, small / PARQUET, compression="none")
    assert found(small) == {}


@pytest.mark.parametrize(
    "table", [pa.table({"other": ["a"]}), pa.table({"name": [1]}), pa.table({"name": ["a"]})]
)
def test_a_parquet_of_other_columns_is_seen(small, table):
    """The last one lacks what its column means."""
    parquet.write_table(table, small / PARQUET)
    assert found(small).keys() == {PARQUET}


ERRORS = "benchmark/samples/x.parquet"


@pytest.fixture
def with_errors(small):
    """A bundle with a Parquet file that no CSV has."""
    (small / ERRORS).parent.mkdir()
    table = pa.table({"sample": range(5000), "error_deg": [0.1] * 5000})
    parquet.write_table(table, small / ERRORS, row_group_size=500)
    package = json.loads((small / DESCRIPTOR).read_text("utf-8"))
    package["resources"].append(
        {
            "name": "errors-x",
            "title": "x: errors",
            "description": "Errors. sample: its number. error_deg: its error.",
            "path": ERRORS,
            "licenses": package["resources"][0]["licenses"],
        }
    )
    (small / DESCRIPTOR).write_text(json.dumps(package))
    crate = json.loads((small / CRATE).read_text("utf-8"))
    one = next(entity for entity in crate["@graph"] if entity["@id"] == TABLE)
    crate["@graph"].append({**one, "@id": ERRORS})
    (small / CRATE).write_text(json.dumps(crate))
    return small


def test_errors_that_no_csv_has_are_read_to_their_end(with_errors):
    assert found(with_errors) == {}
    data = (with_errors / ERRORS).read_bytes()
    for at in (0, len(data) // 2, len(data) - 1):
        (with_errors / ERRORS).write_bytes(data[:at])
        assert found(with_errors).keys() == {ERRORS}
    middle = len(data) // 3
    (with_errors / ERRORS).write_bytes(data[:middle] + bytes(400) + data[middle + 400 :])
    assert found(with_errors).keys() == {ERRORS}


@pytest.mark.parametrize("name", ["LICENSE", "survey/LICENSE", "bibliography/LICENSE"])
def test_another_licence_is_seen(small, name):
    (small / name).write_text("All rights reserved.\n")
    assert found(small).keys() == {name}


def test_the_licence_of_another_holder_and_year_is_the_same(small):
    text = (small / "LICENSE").read_text("utf-8")
    lines = [
        "Copyright (c) 2031 Somebody Else" if line.startswith("Copyright (c)") else line
        for line in text.splitlines()
    ]
    assert "\n".join(lines) != text.strip()
    (small / "LICENSE").write_text("\n".join(lines))
    assert found(small) == {}


GPL = {"name": "GPL-3.0", "path": "https://www.gnu.org/licenses/gpl-3.0", "title": "GPL"}


@pytest.mark.parametrize(
    "edit",
    [
        lambda package: package.__setitem__("licenses", [GPL]),
        lambda package: package["resources"][0].__setitem__("licenses", [GPL]),
        lambda package: package["resources"][0].pop("licenses"),
    ],
)
def test_a_descriptor_of_another_licence_is_seen(small, edit):
    change(small, edit)
    assert any(
        name == DESCRIPTOR and "expected" in text and "MIT" in text for name, text in verify(small)
    )


def test_a_crate_of_another_licence_is_seen(small):
    def edit(crate):
        for entity in crate["@graph"]:
            if entity["@id"] == "survey/LICENSE":
                entity["license"] = {"@id": "https://spdx.org/licenses/MIT"}

    change(small, edit, CRATE)
    ((name, text),) = verify(small)
    assert name == CRATE
    assert text.endswith("expected CC-BY-4.0")


@pytest.mark.parametrize("version", ["../../x", "", None, "1 2", "0.1.0\x1b[2J"])
def test_a_version_that_is_none_is_seen(small, version):
    change(small, lambda package: package.__setitem__("version", version))
    assert {name for name, _ in verify(small)} == {DESCRIPTOR}
