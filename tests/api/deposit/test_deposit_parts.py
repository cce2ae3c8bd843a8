"""Parts of a bundle by themselves: described tables, sample errors, the archive of the code."""

from __future__ import annotations

import gzip
import hashlib
import json
import shutil
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from api.deposit import code_archive, verification
from api.deposit.code_archive import CodeArchiveError, archive_of, write_code
from api.deposit.crate import CRATE
from api.deposit.package import DESCRIPTOR
from api.metadata.bundled import documents
from api.metadata.errors import write_errors
from api.metadata.identity import identity
from benchmark.results.samples import COLUMNS, DIRECTION_COLUMNS, path_of
from benchmark.results.store import PUBLISHED
from files.checksums import read_checksums

NAME = "pd-slit"
ERRORS, DIRECTIONS = (path_of(NAME, directions=is_directions) for is_directions in (False, True))
TABLE: dict[str, Any] = {
    "type": "table",
    "name": "words",
    "path": "survey/words.csv",
    "title": "Words",
    "description": "A word a row.",
    "schema": {
        "fields": [
            {"name": "word", "type": "string", "description": "as it is spelled"},
            {"name": "year", "type": "year"},
            {"name": "share", "type": "number"},
        ],
        "primaryKey": "word",
    },
}


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.fixture
def bundle(tmp_path: Path) -> Path:
    """One table, the errors of one data set and two files of its samples."""
    for place in (ERRORS, DIRECTIONS):
        (tmp_path / "published" / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(PUBLISHED / place, tmp_path / "published" / place)
    made = tmp_path / "bundle"
    frames = made / "frames" / NAME
    (made / "parquet").mkdir(parents=True)
    frames.mkdir(parents=True)
    pd.DataFrame({"word": ["a"]}).to_parquet(made / "parquet" / "words.parquet")
    meanings = '"arrays": {"sun": "direction", "observations": "signals"}'
    card = f'{{"schema": 1, "files": {{}}, {meanings}}}'
    (frames / "card.json").write_text(card)
    (frames / "test.csv").write_text("sun_x,signal_1,eclipse\n0.5,3.2,False\n")
    (frames / "notes.txt").write_text("of no kind that is described")
    return made


def test_errors_are_copied_and_described_by_their_columns(bundle: Path) -> None:
    published = bundle.parent / "published"
    rows = write_errors(bundle, published)
    assert [row["name"] for row in rows] == [f"errors-{NAME}", f"directions-{NAME}"]
    for row, place, columns in zip(
        rows, (ERRORS, DIRECTIONS), (COLUMNS, DIRECTION_COLUMNS), strict=True
    ):
        assert row["path"] == f"benchmark/{place}"
        assert (bundle / row["path"]).read_bytes() == (published / place).read_bytes()
        assert all(f" {column}: " in row["description"] for column in columns)


def test_documents_name_each_file_with_its_digest_and_each_column_with_its_type(
    bundle: Path,
) -> None:
    write_errors(bundle, bundle.parent / "published")
    made = documents(bundle, identity(), {"resources": [TABLE, {"path": "survey/none.txt"}]})
    assert set(made) == {f"croissant/{name}.json" for name in ("record", "survey", NAME)}
    survey, of_set = made["croissant/survey.json"], made[f"croissant/{NAME}.json"]
    assert made["croissant/record.json"]["distribution"] == []
    for document, paths in (
        (survey, ["parquet/words.parquet"]),
        (of_set, [f"benchmark/{ERRORS}", f"benchmark/{DIRECTIONS}",
                  f"frames/{NAME}/card.json", f"frames/{NAME}/test.csv"]),
    ):  # fmt: skip
        files = document["distribution"]
        assert [(one["contentUrl"], one["sha256"]) for one in files] == [
            (f"../{path}", digest(bundle / path)) for path in paths
        ]
    (words,) = survey["recordSet"]
    assert [one["dataType"] for one in words["field"]] == ["sc:Text", "sc:Integer", "sc:Float"]
    assert [one["description"] for one in words["field"]] == ["as it is spelled", "year", "share"]
    split = of_set["recordSet"][-1]
    assert [(one["dataType"], one["description"]) for one in split["field"]] == [
        ("sc:Float", "direction"),
        ("sc:Float", "signals"),
        ("sc:Boolean", "eclipse"),
    ]


def test_an_archive_of_the_code_is_taken_as_given_and_is_the_only_one(tmp_path: Path) -> None:
    archive, made = tmp_path / "atlas-1.tar.gz", tmp_path / "bundle"
    archive.write_bytes(gzip.compress(b"sources"))
    made.mkdir()
    assert archive_of(made) is None
    write_code(made, archive)
    assert archive_of(made) == "code/atlas-1.tar.gz"
    assert (made / "code" / archive.name).read_bytes() == archive.read_bytes()
    assert (made / "rescore.py").read_text().startswith(('"""', "#!"))
    shutil.copy(archive, made / "code" / "other.tar.gz")
    assert archive_of(made) is None
    for wrong in (tmp_path / "none.tar.gz", tmp_path / "bundle"):
        (other := tmp_path / f"of-{wrong.name}").mkdir()
        with pytest.raises(CodeArchiveError, match="expected a source distribution"):
            write_code(other, wrong)


def test_archives_are_the_same_however_they_are_packed(tmp_path: Path) -> None:
    one, other, third = (tmp_path / f"{n}.tar.gz" for n in range(3))
    one.write_bytes(gzip.compress(b"sources" * 99, 1, mtime=0))
    other.write_bytes(gzip.compress(b"sources" * 99, 9, mtime=5))
    third.write_bytes(gzip.compress(b"others"))
    assert one.read_bytes() != other.read_bytes()
    assert code_archive._same(one, other)
    assert not code_archive._same(one, third)
    third.write_bytes(b"no archive")
    assert not code_archive._same(one, third)


def test_a_package_and_a_crate_agree_with_the_files_that_are_listed(small: Path) -> None:
    """Each untrue number or digest is named."""
    package = json.loads((small / DESCRIPTOR).read_text())
    crate = json.loads((small / CRATE).read_text())
    resource = package["resources"][0]
    path = small / resource["path"]
    path.write_text("name\n" + "a\n" * 400)
    listed = {**read_checksums(small), resource["path"]: digest(path)}
    resource |= {"bytes": path.stat().st_size, "hash": f"sha256:{digest(path)}"}
    at = next(n for n, one in enumerate(crate["@graph"]) if one["@id"] == resource["path"])
    crate["@graph"][at] |= {"contentSize": str(path.stat().st_size), "sha256": digest(path)}
    assert list(verification._of_package(package, small, listed)) == []
    assert list(verification._of_crate(crate, small, listed)) == []
    for name, value, said in (
        ("bytes", resource["bytes"] + 1, "bytes are not those of"),
        ("hash", f"sha256:{'0' * 64}", "hash is not that of"),
    ):
        wrong = {**package, "resources": [{**resource, name: value}, *package["resources"][1:]]}
        (found,) = verification._of_package(wrong, small, listed)
        assert said in found
    twice = {**package, "resources": [resource, *package["resources"]]}
    assert "stands there twice" in " ".join(verification._of_package(twice, small, listed))
    for name, value, said in (
        ("contentSize", "1", "contentSize is not its size"),
        ("sha256", "0" * 64, "sha256 is not that of"),
        ("@id", "nowhere.csv", "is not described"),
    ):
        graph = list(crate["@graph"])
        graph[at] = {**graph[at], name: value}
        found = list(verification._of_crate({**crate, "@graph": graph}, small, listed))
        assert found[0].startswith(resource["path"])
        assert said in found[0]
