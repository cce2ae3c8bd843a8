"""Files for operators name what there is: options of the command, files of the repository."""

import configparser
import json
import re
import shlex
from pathlib import Path

import pytest
import typer

from api.cli.commands.serve import app

ROOT = Path(__file__).resolve().parents[3]
UNIT = ROOT / "deploy" / "sunatlas.service"
CONTAINER = (ROOT / "deploy" / "Containerfile").read_text()


def unit():
    read = configparser.ConfigParser(strict=False, interpolation=None)
    read.optionxform = str
    read.read_string(UNIT.read_text())
    return read


def commands():
    yield shlex.split(unit()["Service"]["ExecStart"])
    yield json.loads(re.findall(r"^CMD (\[.*\])$", CONTAINER, re.MULTILINE)[-1])


@pytest.mark.parametrize("command", list(commands()), ids=["unit", "container"])
def test_the_command_is_understood(command):
    assert command[0].endswith("sunatlas")
    assert command[1] == "serve"
    context = typer.main.get_command(app).make_context("serve", command[2:])
    assert context.params["workers"] == 2
    assert context.params["access_log"] is True


def test_the_container_copies_what_the_package_is_made_of():
    copied = [
        name
        for line in re.findall(r"^COPY (?!--)(.*)$", CONTAINER, re.MULTILINE)
        for name in line.split()[:-1]
    ]
    assert all((ROOT / name).exists() for name in copied)
    pyproject = (ROOT / "pyproject.toml").read_text()
    packages = re.search(r"packages = \[(.*)\]", pyproject[pyproject.index("[tool.hatch") :]).group(
        1
    )
    assert set(re.findall(r'"(\w+)"', packages)) <= set(copied)
    assert re.search(r"^USER \d+$", CONTAINER, re.MULTILINE)


def test_sections_of_the_unit_are_those_of_systemd():
    assert unit().sections() == ["Unit", "Service", "Install"]
