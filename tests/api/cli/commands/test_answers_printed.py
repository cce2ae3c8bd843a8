"""What commands print of an answer: what is not known is left out, and said where it matters."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from typer.testing import CliRunner

import survey_data
from api.cli.boards import overview_text
from api.cli.command_line import app
from api.cli.commands.get import fetch_answer
from api.server import app as service
from benchmark.leaderboard.overview import WITHIN, suffix
from calibrate import calibration, documents, products, recalibration
from calibrate.report.page import Asked
from survey_data import Problem
from tests.api.conftest import Client

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]


def sunatlas(*arguments: object) -> Any:
    call = list(map(str, arguments))
    return CliRunner(env={"COLUMNS": "400"}).invoke(app, call, catch_exceptions=False)


def words(text: str) -> str:
    return " ".join(text.split())


# ---- leaderboard --overview


def test_an_overview_of_one_role_has_one_table() -> None:
    shares = {f"share_{suffix(limit)}": 0.5 for limit in WITHIN}
    counts = {"boards": 4, "median_over_bound": 1.5, "leads": 1, "reachable_10": 3}
    part = {"role": "model", "part": "spm", **counts, **shares}
    document = {"says": "One of two.", "parts": [part, {**part, "part": "lut"}]}
    first, table = overview_text(document).split("\n\n")
    assert first == "One of two."
    heading, _, *lines = table.splitlines()
    assert heading.split()[:2] == ["model", "boards"]
    assert [line.split()[:2] for line in lines] == [["spm", "4"], ["lut", "4"]]
    assert overview_text({**document, "parts": []}) == "One of two.\n"


# ---- claims


#: With a second method, an explanation, both, and neither.
@pytest.mark.parametrize(
    ("name", "second", "explained"),
    [("C04", True, False), ("C05", False, True), ("C10", True, True), ("C29", False, False)],
)
def test_a_claim_says_a_second_method_and_an_explanation_where_it_has_them(
    atlas: Client, name: str, second: bool, explained: bool
) -> None:
    claim = atlas.get(f"/v1/claims/{name}").json()
    assert (bool(claim["second_method"]), bool(claim["explanation"])) == (second, explained)
    shown = words(sunatlas("claims", name).stdout)
    assert (" Second method: " in shown) == second
    assert not explained or shown.endswith(f" {words(claim['explanation'])}")


# ---- get


async def _plain(scope: Mapping[str, Any], receive: Receive, send: Send) -> None:
    """An application that reads the request and answers 404 in plain text."""
    request = await receive()
    assert (request["type"], request["body"], request["more_body"]) == ("http.request", b"", False)
    await send({"type": "http.response.start", "status": 404, "headers": []})
    await send({"type": "http.response.body", "body": scope["path"].encode(), "more_body": True})
    await send({"type": "http.response.body", "body": b" is not here"})


def test_an_answer_is_fetched_in_parts_from_an_application_that_reads_the_request() -> None:
    found = asyncio.run(fetch_answer(_plain, "/a%20b", "x=1", b"text/csv"))
    assert found == (404, b"/a b is not here")


def test_a_refusal_that_is_no_document_is_said_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service, "create_app", lambda _: _plain)
    refused = sunatlas("get", "nowhere")
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert refused.stderr == "sunatlas: /nowhere: not an address of this interface\n"


# ---- survey check


@pytest.mark.parametrize("form", ["table", "csv", "json"])
def test_problems_of_tables_are_lines_on_stderr_and_a_document_in_json_alone(
    monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    problems = [Problem("taxonomy.csv", 3, "value", "stands twice"), Problem("a.csv", 1, None, "b")]
    monkeypatch.setattr(survey_data, "validate", lambda _: problems)
    shown = sunatlas("survey", "check", "--format", form)
    assert shown.exit_code == 1
    assert shown.stderr.splitlines() == [f"sunatlas: {one}" for one in problems]
    if form == "json":
        assert json.loads(shown.stdout) == {"problems": [one.to_dict() for one in problems]}
    else:
        assert shown.stdout == ""


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
    ("change", "applied", "then"),
    [("sign", True, " (applied)"), ("sign", False, " (--apply would change it)"), ("", False, "")],
)
def test_a_finding_says_whether_it_was_applied_or_would_be(
    calibrated: SimpleNamespace, change: str, applied: bool, then: str
) -> None:
    (finding,) = calibrated.findings
    finding.change = change
    calibrated.applied = [finding] if applied else []
    assert f"found: {finding.found}{then}\n" in sunatlas("calibrate", "a.csv").stdout


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
    [
        *(("--config", "a.toml"), ("--init", "a.toml"), ("--certificate", "a.xml")),
        *(("--factory", "a.csv"), ("--apply",), ("--thorough",), ("--model", "lsq")),
    ],
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
