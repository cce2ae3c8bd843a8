"""What commands print of an answer: what is not known is left out, and said where it matters."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from calibrate import calibration, documents, products, recalibration
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
    ("explained", "words", "code"), [(True, ["met"], 0), (True, ["not met"], 3), (False, [], 3)]
)
def test_a_corrected_calibration_is_written_with_its_code(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, explained: bool, words: list[str], code: int
) -> None:
    found = SimpleNamespace(sentence=lambda: "turned by 0.7 deg", explained=explained)
    asked: list[object] = []

    def corrected(*args: object, tell: Any) -> Any:
        asked.append(args[:4])
        tell("polynomials: adds 0 deg")
        judged = [
            SimpleNamespace(requirement=one, word=word, sentence="0.1 of 1 deg")
            for one, word in zip(args[5], words, strict=True)
        ]
        return {"again.json": "{}\n", "again.c": "\n"}, judged

    monkeypatch.setattr(documents, "load", lambda path: f"loaded {path}")
    monkeypatch.setattr(recalibration, "recalibrate", lambda *_: found)
    monkeypatch.setattr(products, "corrected_products", corrected)
    old, out = tmp_path / "old.json", tmp_path / "new" / "out"
    wanted = ["--require", "1deg@rms"] if words else []
    call = ("calibrate", "few.csv", "--onto", old, "--out", out, "--name", "again", *wanted)
    shown = sunatlas(*call)
    assert shown.exit_code == code, shown.stderr
    assert shown.stdout.splitlines() == [
        "turned by 0.7 deg",
        "code: polynomials: adds 0 deg",
        f"wrote again.json, again.c in {out}",
        *(f"requirement 1deg@rms: {word} - 0.1 of 1 deg" for word in words),
    ]
    assert asked == [(f"loaded {old}", found, [Path("few.csv")], "again")]
    assert (out / "again.json").read_text() == "{}\n"


@pytest.mark.parametrize(
    "given",
    [*(("--config", "a.toml"), ("--init", "a.toml"), ("--certificate", "a.xml"))],
)
def test_options_that_a_correction_does_not_take_are_refused_by_name(
    given: tuple[str, ...], tmp_path: Path
) -> None:
    call = ("calibrate", "few.csv", "--onto", "old.json", "--out", tmp_path / "out", *given)
    shown = sunatlas(*call)
    assert shown.exit_code == 2
    assert shown.stderr.rstrip().endswith(f"leave out {given[0]}")
    assert not (tmp_path / "out").exists()
    assert not Path(given[-1]).exists()
