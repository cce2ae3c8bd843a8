"""An export holds what its card says, byte for byte each time, and says what has been changed."""

from __future__ import annotations

import hashlib
import json
import shutil
import stat
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from benchmark import datasets
from benchmark.datasets import export as dataset_export
from benchmark.datasets.corrected import corrections
from benchmark.datasets.export import CARD, ExportError, export
from benchmark.datasets.export_arrays import read_archive, write_archive
from benchmark.datasets.export_verification import verify
from benchmark.results.store import PUBLISHED, Store
from files.checksums import CHECKSUMS, write_checksums
from files.reading import FileRefusedError

FEW = 5
PINS = Store(PUBLISHED).pins()
#: One of each kind of observation, with windows, several arrays, context, elements without frames.
KINDS = (
    *(
        pytest.param(name, marks=pytest.mark.slow)
        for name in ("cmos-single-aperture", "ccd-periodic", "event-l-slit", "pd-orbit")
    ),
    "qpd-single-aperture",
)


def exported(name, out, **options):
    defaults = {"conditions": ["nominal"], "n": FEW, "pins": PINS}
    return export(name, out, **{**defaults, **options})


@pytest.fixture(scope="module", params=KINDS)
def made(request, tmp_path_factory):
    return exported(request.param, tmp_path_factory.mktemp("export") / request.param)


@pytest.fixture(scope="module")
def quads(tmp_path_factory):
    return exported("qpd-single-aperture", tmp_path_factory.mktemp("export") / "qpd")


@pytest.fixture
def copy(quads, tmp_path):
    return Path(shutil.copytree(quads.directory, tmp_path / "copy"))


def content(directory):
    return {
        path.relative_to(directory).as_posix(): path.read_bytes()
        for path in directory.rglob("*")
        if path.is_file()
    }


def test_the_card_lists_every_file_with_its_bytes(made):
    card = json.loads((made.directory / CARD).read_text("utf-8"))
    assert card == made.card
    assert {file["path"] for file in card["files"]} | {CARD, CHECKSUMS} == set(made.files)
    for file in card["files"]:
        found = (made.directory / file["path"]).read_bytes()
        assert (file["bytes"], file["sha256"]) == (len(found), hashlib.sha256(found).hexdigest())
    assert verify(made.directory) == []


def test_flats_and_darks_are_those_of_the_data_set(made):
    preset = datasets.get(made.card["name"])
    written = {f["condition"]: f for f in made.card["files"] if f["kind"] == "references"}
    for condition in made.card["exported"]["conditions"]:
        expected = preset.references(condition)
        assert (condition in written) == bool(expected)
        if expected:
            arrays = read_archive(made.directory / written[condition]["path"])
            assert set(arrays) == set(expected) <= set(made.card["arrays"])
            for name, array in expected.items():
                np.testing.assert_array_equal(arrays[name], array)


@pytest.mark.slow
def test_readings_taken_again_are_exported_beside_those_of_the_calibration(tmp_path):
    """Without them nobody corrects the samples of a flight as they are scored."""
    made = exported("pd-slit", tmp_path / "out", conditions=["flight", "hot", "hot-renewed"])
    preset = datasets.get("pd-slit")
    found = {f["path"] for f in made.card["files"] if f["kind"] == "references"}
    assert found == {
        *("flight/references.npz", "flight/references-test.npz", "hot/references.npz"),
        *("hot-renewed/references.npz", "hot-renewed/references-test.npz"),
    }
    for condition in ("flight", "hot-renewed"):
        by = corrections(preset, condition)["test"]
        again = read_archive(made.directory / condition / "references-test.npz")
        np.testing.assert_array_equal(again["dark_ua"], by.dark)
        np.testing.assert_array_equal(again["flat_ua"], by.flat)
    assert verify(made.directory) == []


def test_other_people_s_tools_check_the_sums(made):
    run = subprocess.run(
        ["sha256sum", "--check", "--strict", CHECKSUMS],
        cwd=made.directory,
        capture_output=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


def test_tables_read_back_as_the_arrays(made):
    tables = [file for file in made.card["files"] if file["kind"] == "table"]
    assert bool(tables) == (made.card["observation"] == "currents")
    for file in tables:
        table = pd.read_csv(made.directory / file["path"])
        assert list(table.columns) == file["columns"]
        arrays = read_archive((made.directory / file["path"]).with_suffix(".npz"))
        for name, array in arrays.items():
            if array.ndim == 1:
                columns = [name]
            elif name == "observations":
                columns = [f"signal_{k + 1}" for k in range(array.shape[1])]
            else:
                columns = [f"{name}_{axis}" for axis in "xyz"]
            found = table[columns].to_numpy().reshape(array.shape)
            assert found.dtype == array.dtype
            np.testing.assert_array_equal(found, array)


def test_a_flipped_byte_is_found_in_any_file(copy):
    for name in [*content(copy)]:
        if name == CHECKSUMS:
            continue
        path = copy / name
        good = path.read_bytes()
        for place in (0, len(good) // 2, len(good) - 1):
            path.write_bytes(good[:place] + bytes([good[place] ^ 1]) + good[place + 1 :])
            ((where, what),) = verify(copy)
            assert where == name
            assert what.startswith("SHA-256 is ")
        path.write_bytes(good)
    assert verify(copy) == []


def test_what_the_card_no_longer_says_is_found(copy):
    (copy / "nominal" / "test.npz").unlink()
    write_checksums(copy)
    ((where, what),) = verify(copy)
    assert where == CARD
    assert "files are " in what
    (copy / CARD).write_text('{"schema": 1, "files": [3]}')
    write_checksums(copy)
    with pytest.raises(ExportError, match="not the card of an export"):
        verify(copy)


@pytest.mark.parametrize(
    ("card", "says"),
    [
        (None, "it has no card.json"),
        ("{", "not JSON"),
        ("[]", "not the card"),
        ('{"schema": 99, "files": []}', "schema 1"),
    ],
)
def test_a_directory_that_is_no_export_is_refused(tmp_path, card, says):
    with pytest.raises(ExportError, match=CHECKSUMS):
        verify(tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    if card is not None:
        (tmp_path / CARD).write_text(card)
    write_checksums(tmp_path)
    with pytest.raises(ExportError, match=says):
        verify(tmp_path)
    (tmp_path / CHECKSUMS).write_text("00  x\n")
    with pytest.raises(FileRefusedError):
        verify(tmp_path)


def test_a_failure_half_way_leaves_nothing(tmp_path, monkeypatch):
    def failing(*_):
        raise OSError("disk full")

    monkeypatch.setattr(dataset_export, "preview_png", failing)
    with pytest.raises(OSError, match="disk full"):
        exported("qpd-single-aperture", tmp_path / "out")
    assert list(tmp_path.iterdir()) == []


ARRAYS = {
    "observations": np.arange(8.0).reshape(2, 4) / 3,
    "sun": np.array([[0.0, 0.6, 0.8], [0.1, 0.2, 0.3]]),
    "origin_px": np.array([[1, 2], [3, 4]]),
    "observable": np.array([True, False]),
    "bound_deg": np.array([0.5, np.inf]),
}


def test_an_archive_is_the_same_bytes_readable_by_all(tmp_path: Path) -> None:
    write_archive(tmp_path / "a.npz", ARRAYS)
    write_archive(tmp_path / "b.npz", ARRAYS)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert [entry.filename for entry in archive.infolist()] == [f"{n}.npy" for n in ARRAYS]
        for entry in archive.infolist():
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert entry.create_system == 3
            mode = entry.external_attr >> 16
            assert stat.S_ISREG(mode)
            assert stat.S_IMODE(mode) == 0o644
            assert entry.compress_type == zipfile.ZIP_DEFLATED
    found = read_archive(tmp_path / "a.npz")
    assert list(found) == list(ARRAYS)
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found[name], array, strict=True)
    (tmp_path / "c.npz").write_text("no archive")
    with pytest.raises(ValueError, match=r"c\.npz: not an archive of arrays"):
        read_archive(tmp_path / "c.npz")


@pytest.mark.parametrize("n", [0, -1])
def test_an_export_is_of_one_sample_at_least(tmp_path: Path, n: int) -> None:
    with pytest.raises(ValueError, match=rf"^n\b.*\b1\b.* {n}$"):
        export("pd-maskless-cube", tmp_path / "out", n=n)
    assert list(tmp_path.iterdir()) == []
