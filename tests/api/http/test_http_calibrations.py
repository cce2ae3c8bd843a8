"""Files that are sent are calibrated, or refused within bounds; nothing of them is kept."""

from __future__ import annotations

import gzip
import hashlib
import io
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from calibrate import uploaded
from calibrate.settings import Kind
from calibrate.uploaded import Upload, UploadRefusedError, calibrate_uploads

BAD = b"x_px,y_px,alpha,beta\n1,b,3,4\n"
ADDRESS = "/v1/calibrations"


@pytest.fixture(scope="module", autouse=True)
def patience():
    """Give all the time they need to processes that take the processor when nobody else does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(uploaded, "_PATIENCE", 60.0)
        yield


def turntable() -> bytes:
    """A small camera behind a pinhole."""
    line = np.linspace(-40, 40, 9)
    beta, alpha = (grid.ravel() for grid in np.meshgrid(line, line))
    a, b = np.radians(alpha), np.radians(beta)
    sun = np.column_stack([np.sin(b) * np.cos(a), np.sin(a), np.cos(b) * np.cos(a)])
    noise = np.random.default_rng(1).normal(0.0, 0.05, (len(sun), 2))
    rows = np.column_stack([512 + 350 * sun[:, :2] / sun[:, 2:] + noise, alpha, beta])
    text = io.StringIO()
    header = "x_px,y_px,theta_x_deg,theta_y_deg"
    np.savetxt(text, rows, "%.4f", ",", header=header, comments="")
    return text.getvalue().encode()


@pytest.fixture(scope="module")
def zipped(atlas):
    """All files of a calibration of which something is required."""
    asked = {"answer": "zip", "model": "homography", "require": "2deg@95%,30deg"}
    files = {"file": ("../../bench.csv", turntable())}
    answer = atlas.post(ADDRESS, files=files, data=asked)
    assert answer.status_code == 200, answer.text
    assert answer.headers["content-type"] == "application/zip"
    assert answer.headers["cache-control"] == "no-store"
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        return {name: archive.read(name).decode() for name in archive.namelist()}


def test_a_file_becomes_report_json_and_code(zipped):
    assert {name.rpartition(".")[2] for name in zipped} == {
        "json",
        "html",
        "py",
        "c",
        "h",
        "sha256",
    }
    document = json.loads(zipped["sun_sensor.json"])
    assert document["verdict"]["verdict"] == "good"
    assert document["model"]["name"] == "homography", "the only one tried"
    assert document["made"]["files"] == ["bench.csv"]
    assert zipped["sun_sensor_report.html"].count("<svg") == 5
    assert "Requirement 2deg@95%,30deg: met." in zipped["sun_sensor_report.html"]
    listed = dict(line.split("  ")[::-1] for line in zipped["sun_sensor.sha256"].splitlines())
    assert listed.keys() == zipped.keys() - {"sun_sensor.sha256"}
    for name, digest in listed.items():
        assert hashlib.sha256(zipped[name].encode()).hexdigest() == digest


def test_the_page_takes_a_form_without_a_script_and_keeps_nothing(atlas, tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    page = atlas.get("/calibrate")
    assert page.status_code == 200
    assert 'enctype="multipart/form-data"' in page.text
    offered = json.loads(re.findall(r'"kinds": (\[\[.*?\]\])', page.text)[0])
    assert [kind for kind, _ in offered] == [kind for kind in get_args(Kind) if kind != "frames"]
    refused = atlas.post(
        "/calibrate", files={"file": ("b.csv", BAD)}, headers={"Accept": "text/html"}
    )
    assert refused.status_code == 422
    assert "2, column y_px" in refused.text
    assert list(tmp_path.iterdir()) == []
    assert refused.headers["content-type"].startswith("text/html")


def test_columns_are_previewed_with_role_unit_and_first_values(atlas):
    found = atlas.post(ADDRESS + "/preview", files={"file": ("b.csv", turntable())}).json()
    assert [one["name"] for one in found["columns"]] == [
        *("x_px", "y_px", "theta_x_deg", "theta_y_deg")
    ]
    assert found["columns"][2]["unit"] == "deg"
    assert found["rows"] == 81


def test_a_model_is_filled_in_by_the_address(atlas):
    assert 'name="model" value="homography"' in atlas.get("/calibrate?model=homography").text


@pytest.mark.parametrize(
    ("options", "status", "said"),
    [
        ({"json": {}}, 415, "multipart/form-data"),
        ({"files": {"file": ("b.csv", BAD)}, "data": {"aply": "true"}}, 400, "apply"),
        ({"files": {"config": (None, "")}}, 422, "a file"),
        ({"files": {"file": ("b.csv", BAD)}, "data": {"ticket": "*"}}, 422, "[0-9a-f]{16,64}"),
        ({"files": {"file": ("b.csv", b"x" * 10_200_000)}}, 413, "at most"),
        (
            {
                "content": b"--a\r\nno head",
                "headers": {"Content-Type": "multipart/form-data; boundary=a"},
            },
            400,
            "RFC 7578",
        ),
    ],
)
def test_what_is_no_such_form_is_refused_with_a_reason(atlas, options, status, said):
    answer = atlas.post(ADDRESS, **options)
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"
    assert said in answer.json()["detail"]


def packed(name: str, size: int) -> bytes:
    made = io.BytesIO()
    quickly = zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED, compresslevel=1)
    with quickly as archive, archive.open(name, "w") as f:
        for _ in range(size // 2**20):
            f.write(bytes(2**20))
    return made.getvalue()


def npy(header: str) -> bytes:
    text = header.encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def pickled() -> bytes:
    made = io.BytesIO()
    np.save(made, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    return made.getvalue()


def columns(count: int) -> bytes:
    return b",".join(b"c%d" % n for n in range(count)) + b"\n" + b",".join([b"1"] * count)


HOSTILE = {
    "million-columns.csv": lambda: columns(1_000_000),
    "formulas.csv": lambda: b'x_px,y_px,alpha,beta\n=cmd|"/c calc"!A1,2,3,4\n',
    "nan.csv": lambda: b"x_px,y_px,alpha,beta\n" + b"nan,nan,nan,nan\n" * 1000,
    "bomb.npz": lambda: packed("x_px.npy", 2**30 + 2**20),
    "bomb.xlsx": lambda: packed("xl/worksheets/sheet1.xml", 2**30 + 2**20),
    "gzip.csv": lambda: gzip.compress(bytes(50_000_000)),
    "pickle.npy": pickled,
    "huge.npy": lambda: npy(
        "{'descr': [('x_px', '<f8')], 'fortran_order': False, 'shape': (1000000000000,), }"
    ),
    "deep.npy": lambda: npy("[" * 100),
    "deep.json": lambda: b"[" * 200_000,
    "not.parquet": lambda: b"PAR1" + bytes(1000) + b"PAR1",
    "quoted.csv": lambda: b'"' + b"a" * 1_000_000 + b"\n1,2\n",
    "no-ending": lambda: BAD,
}


#: Each is refused in a process of its own, which takes a second.
SOME_HOSTILE = ("bomb.npz",)


@pytest.mark.parametrize(
    "names", [SOME_HOSTILE, pytest.param(tuple(HOSTILE), marks=pytest.mark.slow)], ids=len
)
def test_hostile_files_are_refused_within_time_and_memory(names):
    """In a process of their own: the memory of a child that is forked is its parent's, too."""
    code = (
        "import json, resource, runpy, sys\n"
        "from calibrate.uploaded import Upload, UploadRefusedError, calibrate_uploads\n"
        "made = runpy.run_path(sys.argv[1])['HOSTILE']\n"
        "for name in sys.argv[2:]:\n"
        "    try:\n"
        "        calibrate_uploads([Upload(name, made[name]())], longest_s=300.0)\n"
        "        said = 'accepted'\n"
        "    except UploadRefusedError as error:\n"
        "        said = str(error)\n"
        "    used = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss\n"
        "    print(json.dumps([name, said, used]))\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, __file__, *names], check=True, capture_output=True, text=True
    )
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    assert tuple(name for name, _, _ in lines) == names
    for name, said, largest in lines:
        assert said != "accepted", name
        assert "over 300 s" not in said, name
        assert "ended early" not in said, name
        assert len(said) < 1000, name
        assert largest < 1_000_000, (name, largest)  # kB


def test_a_name_leads_nowhere_else(monkeypatch):
    for name in ("../../etc/passwd", "/etc/passwd", "C:\\x\\..\\b.csv", "..", "", "a/../../b"):
        made = Path("/there") / uploaded._safe(name, 0)
        assert made.parent == Path("/there/0")
        assert made.name not in {"", ".", ".."}


def test_what_takes_too_long_is_ended():
    with pytest.raises(UploadRefusedError, match="took over"):
        calibrate_uploads([Upload("b.csv", turntable())], longest_s=0.3)
