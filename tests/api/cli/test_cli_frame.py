"""What every command of `sunatlas` keeps: quick help, one-line errors, exit codes, quiet pipes."""

import importlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from api.cli import command_line
from api.cli.command_line import COMMANDS, DEBUG, app
from api.deposit.bundle import DepositError
from benchmark.contract import UnknownNameError
from benchmark.results.csv_tables import StoreError

ROOT = Path(__file__).resolve().parents[3]
SUNATLAS = (sys.executable, "-m", "api.cli.command_line")
HEAVY = ("pandas", "cv2", "scipy", "plotly", "numba", "numpy", "fastapi", "frictionless", "rich")


def sunatlas(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*SUNATLAS, *arguments],
        cwd=ROOT,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def invoke(*arguments: str):
    return CliRunner().invoke(app, list(arguments), catch_exceptions=False)


def test_help_names_every_command_and_imports_none_of_them():
    shown = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "api.cli.command_line", "--help"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    imported = {line.rpartition("|")[2].strip() for line in shown.stderr.splitlines()}
    assert {"typer", "typer.core"} <= imported  # the list is what it is taken for
    assert not {name for name in imported if name.partition(".")[0] in HEAVY}
    assert not {name for name in imported if name.startswith("api.cli.commands")}
    for name, line in COMMANDS.items():
        assert re.search(rf"^  {name} +{re.escape(line)}$", shown.stdout, re.MULTILINE)


def test_importing_api_imports_nothing_heavy():
    code = "import sys, api; print(*sys.modules)"
    shown = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert not {m for m in shown.stdout.split() if m.partition(".")[0] in HEAVY}


def test_the_line_in_the_help_is_the_first_of_the_command_s_own():
    for name, line in COMMANDS.items():
        command = command_line.load(name)
        assert command.name == name
        assert (command.help or "").partition("\n")[0] == line


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_explains_itself(name):
    shown = invoke(name, "--help")
    assert shown.exit_code == 0
    assert shown.stdout.startswith(f"Usage: sunatlas {name}")


def test_version_is_the_project_s():
    declared = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert invoke("--version").stdout == f"sunatlas {declared[1]}\n"


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["studes"], "'studies'"),
        (["studies", "--detectr", "CMOS"], "--detector"),
        (["studies", "--detector", "CMSO"], "--detector: no 'CMSO'"),
        (["studies", "Chang208"], "did you mean 'Chang2008'?"),
        (["studies", "--format", "yaml"], "yaml"),
        (["studies", "--year-min", "soon"], "--year-min"),
        (["studies", "Chang2008", "--detector", "CMOS"], "a study's key goes without --detector"),
        (["recommend", "--task", "Acuracy"], "did you mean 'Accuracy'?"),
        (["recommend", "--exclude-mask", "Slitt"], "did you mean 'Slit'?"),
        (["recommend", "--max-error-deg", "-1"], "--max-error-deg"),
        (["recommend", "--survive", "albdo"], "--survive: no 'albdo'"),
        (["run", "Chang208"], "did you mean 'Chang2008'?"),
        (["run"], "study"),
        (["run", "Chang2008", "--workers", "0"], "--workers"),
        (["serve", "--port", "70000"], "--port"),
        (["deposit", "bild"], "'build'"),
    ],
)
def test_a_wrong_call_is_one_line_and_2(arguments, says):
    shown = invoke(*arguments)
    assert shown.exit_code == 2
    assert shown.stdout == ""
    assert shown.stderr.startswith("sunatlas: ")
    assert shown.stderr.count("\n") == 1
    assert says in shown.stderr


@pytest.mark.parametrize("arguments", [(), ("survey",), ("dataset",), ("deposit",)])
def test_a_call_that_asks_nothing_is_told_what_can_be_asked_and_is_2(arguments):
    shown = invoke(*arguments)
    assert shown.exit_code == 2
    assert shown.stdout == invoke(*arguments, "--help").stdout
    assert "Commands:" in shown.stdout
    assert shown.stderr == ""


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["dataset", "describe", "cmos-singel-aperture"], "'cmos-single-aperture'"),
        (["benchmark", "--dataset", "cmos-singel-aperture"], "'cmos-single-aperture'"),
        (["benchmark", "--model", "lsqq"], "'lsq'"),
        (["survey", "check", "--data", "nowhere"], "nowhere"),
        (["survey", "import", "nowhere.csv"], "nowhere.csv"),
        (["deposit", "verify", "nowhere"], "nowhere"),
    ],
)
def test_a_name_that_is_not_there_is_one_line_and_1(arguments, says):
    shown = invoke(*arguments)
    assert shown.exit_code == 1
    assert shown.stdout == ""
    assert shown.stderr.startswith("sunatlas: ")
    assert shown.stderr.count("\n") == 1
    assert says in shown.stderr


@pytest.mark.slow
def test_tracebacks_are_kept_for_those_who_ask():
    arguments = ("dataset", "describe", "no-such-dataset")
    assert "Traceback" not in sunatlas(*arguments, **{DEBUG: ""}).stderr
    shown = sunatlas(*arguments, **{DEBUG: "1"})
    assert shown.returncode == 1
    assert "Traceback" in shown.stderr


@pytest.mark.parametrize(
    "error", [ValueError("shapes (3,) (2,)"), np.linalg.LinAlgError("singular"), KeyError("rms")]
)
def test_a_mistake_of_the_program_shows_as_one(monkeypatch, error):
    def mistaken(*_arguments, **_options):
        raise error

    monkeypatch.setattr(importlib.import_module("api.cli.commands.dataset"), "emit", mistaken)
    with pytest.raises(type(error), match=re.escape(str(error))):
        invoke("dataset", "list")


def test_errors_of_ours_and_of_the_file_system_are_known():
    ours = [UnknownNameError("dataset", "x", ["y"]), StoreError("line 1"), DepositError("no")]
    assert all(map(command_line.is_known, [*ours, FileNotFoundError("x"), PermissionError("y")]))
    theirs = [ValueError("x"), LookupError("x"), json.JSONDecodeError("x", "", 0), ImportError("x")]
    assert not any(map(command_line.is_known, theirs))


@pytest.mark.slow
@pytest.mark.parametrize("form", ["table", "json"])
def test_a_reader_that_leaves_early_hears_nothing(form):
    process = subprocess.Popen(
        [*SUNATLAS, "studies", "--format", form],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    process.stdout.close()
    _, said = process.communicate(timeout=600)
    assert process.returncode == 1
    assert said == b""


def test_ctrl_c_ends_a_command_with_130_and_a_line(monkeypatch):
    def interrupted(*_arguments, **_options):
        raise KeyboardInterrupt

    module = importlib.import_module("api.cli.commands.dataset")
    monkeypatch.setattr(module, "emit", interrupted)
    shown = invoke("dataset", "list")
    assert shown.exit_code == 130
    assert shown.stderr == "sunatlas: interrupted\n"
