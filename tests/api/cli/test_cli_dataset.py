"""`sunatlas dataset`: files that hold what was asked for, checks that find what was changed."""

import csv
import io
import json

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.cli.commands import dataset
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark import datasets
from benchmark.contract import Cell
from benchmark.results.samples import Directions, SampleErrors

CUBE = "pd-maskless-cube"
APERTURE = "cmos-single-aperture"


def sunatlas(*arguments):
    return CliRunner().invoke(app, ["dataset", *map(str, arguments)])


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    out = tmp_path_factory.mktemp("export") / "cube"
    arguments = ("--condition", "nominal", "--condition", "albedo", "--n", 4)
    shown = sunatlas("export", CUBE, "--out", out, *arguments, "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    return out, shown


@pytest.mark.slow
def test_exports_load_with_plain_numpy_and_pandas(made):
    out, _ = made
    table = pd.read_csv(out / "albedo" / "test.csv")
    with np.load(out / "albedo" / "test.npz") as arrays:
        assert len(table) == len(arrays["sun"]) == 4
        signals = table.filter(like="signal_").to_numpy()
        np.testing.assert_array_equal(signals, arrays["observations"])
        whole = datasets.get(CUBE).generate("albedo", "test")
        np.testing.assert_array_equal(signals, whole.observations[:4])


@pytest.mark.slow
def test_verify_passes_then_names_what_was_changed(made, tmp_path):
    out, _ = made
    shown = sunatlas("verify", out)
    assert (shown.exit_code, shown.stdout) == (0, "")
    quick = sunatlas("verify", out, "--quick")
    assert (quick.exit_code, quick.stdout) == (0, "")
    assert shown.stderr != quick.stderr, "each says whether it was made again"
    for one in (shown, quick):
        assert one.stderr.startswith(f"{out}: ")
        assert one.stderr.count("\n") == 1
    assert json.loads(sunatlas("verify", out, "--quick", "--format", "json").stdout) == []
    path = out / "nominal" / "test.npz"
    good = path.read_bytes()
    path.write_bytes(good[:-1] + bytes([good[-1] ^ 1]))
    shown = sunatlas("verify", out, "--format", "csv")
    path.write_bytes(good)
    assert shown.exit_code == 1
    (row,) = csv.DictReader(io.StringIO(shown.stdout))
    assert row["file"] == "nominal/test.npz"
    assert row["problem"].startswith("SHA-256 is")


@pytest.fixture
def sampled(tmp_path, monkeypatch):
    """A record with errors of one pipeline on two units, which the command shows."""
    found = SampleErrors()
    found.directions[APERTURE] = Directions(np.eye(3)[:2], np.ones(2, bool), np.full(2, 0.5))
    for unit in (0, 4):
        cell = Cell(APERTURE, "nominal", "bctm", "pinhole", unit)
        found.add(cell, [0.25 + unit, np.nan], [True, False])
    found.write(tmp_path, lambda _cell: True)
    known = Knowledge(Measurements(tmp_path))
    monkeypatch.setattr(dataset, "knowledge", lambda: known)
    return tmp_path / "samples" / f"{APERTURE}.parquet"


def test_errors_are_shown_and_saved_as_csv_and_as_the_published_file(sampled, tmp_path):
    out = tmp_path / "some.csv"
    assert sunatlas("errors", APERTURE, "--unit", 4, "--out", out).exit_code == 0
    table = pd.read_csv(out)
    assert table["unit"].tolist() == [4, 4]
    assert table["error_deg"].tolist()[0] == 4.25
    assert table["outcome"].tolist() == [0, 1]
    shown = json.loads(sunatlas("errors", APERTURE, "--format", "json").stdout)
    assert [row["error_deg"] for row in shown] == [0.25, None, 4.25, None]
    whole = tmp_path / "all.parquet"
    assert sunatlas("errors", APERTURE, "--out", whole).exit_code == 0
    assert whole.read_bytes() == sampled.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((APERTURE, "--unit", 4, "--out", "x.parquet"), "has all pipelines"),
        (("ccd-slit", "--out", "x.parquet"), "no errors of ccd-slit"),
    ],
)
def test_errors_refuse_what_they_cannot_give(sampled, arguments, said):
    shown = sunatlas("errors", *arguments)
    assert shown.exit_code != 0
    assert said in f"{shown.stderr}{shown.exception}"


def test_built_sensors_stand_beside_their_figures_as_sold():
    shown = sunatlas("sold", "--format", "json")
    assert shown.exit_code == 0, shown.stderr
    document = json.loads(shown.stdout)
    rows = {row["hardware"]: row for row in document["items"]}
    assert rows["C13"]["stated_deg"] == 1.5
    assert rows["C13"]["simulated_deg"] == rows["C13"]["uncalibrated_deg"]
    assert all(bool(row["reason"]) != bool(row["agrees"]) for row in rows.values())
    near = sum(row["agrees"] is True for row in rows.values())
    assert document["words"].startswith(f"{near} of {len(rows)} built sensors")
    without = {row["hardware"]: row["reason"] for row in document["left_out"]}
    assert "not measured" in without["P12"]
    assert not without.keys() & rows.keys()
    said = " ".join(sunatlas("sold").stdout.split())
    assert document["words"] in said
