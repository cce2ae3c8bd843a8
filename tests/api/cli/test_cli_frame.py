"""What every command of `sunatlas` keeps: quick help, and what can be asked."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from api.cli import command_line
from api.cli.command_line import COMMANDS, app

ROOT = Path(__file__).resolve().parents[3]
HEAVY = ("pandas", "cv2", "scipy", "plotly", "numba", "numpy", "fastapi", "frictionless", "rich")


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


def test_the_line_in_the_help_is_the_first_of_the_command_s_own():
    for name, line in COMMANDS.items():
        command = command_line.load(name)
        assert command.name == name
        assert (command.help or "").partition("\n")[0] == line


def test_version_is_the_project_s():
    declared = re.search(r'^version = "(.+)"$', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)
    assert invoke("--version").stdout == f"sunatlas {declared[1]}\n"


@pytest.mark.parametrize("arguments", [(), ("survey",), ("dataset",), ("deposit",)])
def test_a_call_that_asks_nothing_is_told_what_can_be_asked_and_is_2(arguments):
    shown = invoke(*arguments)
    assert shown.exit_code == 2
    assert shown.stdout == invoke(*arguments, "--help").stdout
    assert "Commands:" in shown.stdout
    assert shown.stderr == ""
