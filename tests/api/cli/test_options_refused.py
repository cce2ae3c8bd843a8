"""Options that do not apply are refused in one sentence; examples in the help are right."""

from __future__ import annotations

import re
import subprocess
import sys
from itertools import takewhile
from pathlib import Path
from typing import Annotated

import pytest
import typer
from pydantic import TypeAdapter
from typer.testing import CliRunner

from api.cli.command_line import COMMANDS, app, load
from api.schema.parameters import OneOf, WordsUnreadableError
from benchmark.plan.parts import every_part

ROOT = Path(__file__).resolve().parents[3]
FILE = "pyproject.toml"  # any that is there: it is not read

#: A call, and the options (or what else they are beside) that its refusal names.
IDLE = [
    ("benchmark --data x.csv --workers 2", "--data --workers"),
    ("benchmark --data x.csv --dataset pd-slit", "--data --dataset"),
    (f"calibrate {FILE} --init x.toml --out out", "--init --out"),
    (f"calibrate {FILE} --onto x.json --config x.toml", "--onto --config"),
    ("claims C04 --verdict refuted", "ID --verdict"),
    ("dataset fetch cubesatbox --scores --out x", "--scores --out"),
    ("dataset errors pd-slit --out x.csv --format json", "--out --format"),
    ("deposit publish 1 --production --server https://x.example", "--production --server"),
    ("deposit verify out --alone --quick", "--alone --quick"),
    ("leaderboard --check --dataset pd-slit", "--check --dataset"),
    ("leaderboard --each --dataset pd-slit", "--each --dataset"),
    ("leaderboard --field 10 --max-error 1", "--field --max-error"),
    ("recommend --calibrations 2", "--calibrations --include"),
    ("recommend --format csv --limit 3", "--format --limit"),
    ("run --suite quick --condition nominal", "--condition suite"),
    ("studies Chang2008 --detector CMOS", "key --detector"),
    (f"survey import {FILE} --replace Doe2030", "--replace bibliography"),
    ("verify --suite quick --seed 3", "--suite --seed"),
]


@pytest.mark.parametrize(("call", "named"), IDLE)
def test_an_option_without_an_effect_is_refused_by_name(call: str, named: str) -> None:
    refused = CliRunner().invoke(app, call.split(), catch_exceptions=False)
    assert (refused.exit_code, refused.stdout) == (2, ""), refused.stdout
    assert refused.stderr.count("\n") == 1
    for word in named.split():
        assert word in refused.stderr


def helped() -> dict[str, str]:
    """Return the help of every command and of its commands, by the words that call it."""
    found, left = {}, {name: load(name) for name in COMMANDS}
    while left:
        call, command = left.popitem()
        found[call] = command.get_help(typer.Context(command, info_name=call))
        left |= {f"{call} {name}": one for name, one in getattr(command, "commands", {}).items()}
    return found


def test_commands_that_the_help_shows_are_understood() -> None:
    text = " ".join(" ".join(helped().values()).split())
    shown = set(re.findall(r"`([^`]+)`", text))
    calls = [one.split()[1:] for one in shown if one.startswith("sunatlas ")]
    assert len(calls) > 5
    for words in (w for w in calls if w[0] != "completion"):
        names = list(takewhile(re.compile("[a-z]+$").match, words))
        read = CliRunner().invoke(app, [*names, "--help"], catch_exceptions=False)
        assert read.exit_code == 0, (words, read.stderr)
        for option in (word for word in words if word.startswith("--")):
            assert option in read.stdout, words


def test_names_that_the_help_gives_as_examples_are_there() -> None:
    text = " ".join(" ".join(helped().values()).split())
    given = set(re.findall(r"such as ([a-z][a-z0-9-]+)(?=[,.; ])", text))
    parts = every_part()
    known = {*parts.extractors, *parts.models}
    assert given
    assert {name for name in given if name not in known} == set()


@pytest.mark.slow
@pytest.mark.parametrize("limit", ["-v 300000", "-n 5"])
def test_a_command_short_of_memory_or_files_says_so_in_a_line(limit: str) -> None:
    call = f"ulimit {limit}; exec '{sys.executable}' -m api.cli.command_line recommend"
    shell = ["/bin/sh", "-c", f"{call} --detector CMOS"]
    ended = subprocess.run(shell, cwd=ROOT, capture_output=True, text=True, check=False)
    assert "Traceback" not in ended.stderr
    assert "did you mean" not in ended.stderr
    if ended.returncode == 0:
        pytest.skip("enough for a command on this machine")
    assert re.search(r"^sunatlas: .*(memory|open files)", ended.stderr, re.MULTILINE)


def test_words_that_cannot_be_read_are_not_a_fault_of_the_word() -> None:
    def words() -> list[str]:
        raise ValueError("taxonomy.csv: the file is damaged")

    with pytest.raises(WordsUnreadableError, match="is damaged"):
        TypeAdapter(Annotated[str, OneOf(words)]).validate_python("CMOS")
