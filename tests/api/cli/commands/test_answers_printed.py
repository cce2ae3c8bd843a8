"""What commands print of an answer: what is not known is left out, and said where it matters."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from calibrate import calibration, products
from calibrate.report.page import Asked


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "400"}).invoke(app, call, catch_exceptions=False)


# ---- leaderboard --overview


# ---- claims


# ---- get


# ---- survey check


# ---- calibrate


@pytest.fixture
def calibrated(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """What a calibration found, to be altered; products are named and not written."""
    finding = SimpleNamespace(found="alpha has the other sign", change="sign")
    found = SimpleNamespace(
        verdict=SimpleNamespace(word="good", reason="errors are noise"),
        chosen=SimpleNamespace(name="pinhole", rms_deg=0.01234),
        findings=[finding],
        applied=[],
        notes=["semicolons divide the columns"],
        excluded=[SimpleNamespace(reason="far off")] * 2,
        readings=SimpleNamespace(dropped={"no reading": 3}),
    )
    written = [Path("out/a.html"), Path("out/a.json")]
    monkeypatch.setattr(calibration, "calibrate", lambda *_, **__: found)

    def write(
        _found: object, out: Path, _name: str, _command: str, asked: Asked, **_: object
    ) -> list[Path]:
        if asked.certificate:
            out.mkdir()
            (out / asked.certificate).write_text("<dcc/>\n", encoding="utf-8")
        return written

    monkeypatch.setattr(products, "write_products", write)
    return found


def test_a_calibration_says_what_was_found_read_and_left_out(
    calibrated: SimpleNamespace, tmp_path: Path
) -> None:
    to = tmp_path / "dcc.xml"
    shown = sunatlas("calibrate", "a.csv", "--out", tmp_path / "out", "--certificate", to)
    assert shown.exit_code == 0, shown.stderr
    assert shown.stdout.splitlines() == [
        "verdict: good - errors are noise",
        "model: pinhole, 0.0123 deg RMS on samples left out",
        "found: alpha has the other sign (--apply would change it)",
        "read: semicolons divide the columns",
        "left out: 3 rows: no reading",
        "left out: 2 rows: far off",
        f"wrote a.html, a.json in {tmp_path / 'out'}",
        f"wrote {to}",
    ]
    assert to.read_text() == "<dcc/>\n"
    calibrated.verdict.word = "doubtful"
    assert sunatlas("calibrate", "a.csv").exit_code == 3


@pytest.mark.parametrize(
    "given",
    [("--config", "a.toml"), ("--init", "a.toml"), ("--certificate", "a.xml")],
)
def test_options_that_a_correction_does_not_take_are_refused_by_name(
    given: tuple[str, ...], tmp_path: Path
) -> None:
    call = ("calibrate", "few.csv", "--onto", "old.json", "--out", tmp_path / "out", *given)
    shown = sunatlas(*call)
    assert shown.exit_code == 2
    assert shown.stderr.rstrip().endswith(f"--onto goes without {given[0]}")
    assert not (tmp_path / "out").exists()
    assert not Path(given[-1]).exists()
