"""Shells complete commands and the names that commands take."""

import os
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from api.cli import completion
from api.cli.command_line import COMMANDS, app
from benchmark import datasets
from benchmark.contract import ON_BENCH
from benchmark.results.store import PUBLISHED, Store
from registry.studies import facts


def asking(line, shell):
    """Return what a shell sets; a line that ends in a space begins a word."""
    words = {
        "bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    return {**words, completion.VARIABLE: f"complete_{shell}"}


def completed(line, shell="bash"):
    """Return what a shell offers behind a line."""
    shown = CliRunner().invoke(app, [], env=asking(line, shell), prog_name="sunatlas")
    assert shown.stderr == ""
    return shown.stdout.split("\n")[:-1] if shell == "bash" else shown.stdout


@pytest.mark.slow
def test_the_program_itself_answers_a_shell():
    line = "sunatlas studies Chang200"
    shown = subprocess.run(
        [sys.executable, "-m", "api.cli.command_line"],
        env={**os.environ, **asking(line, "bash")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert shown.stderr == ""
    assert shown.stdout.split("\n")[:-1] == completed(line)


@pytest.mark.parametrize(
    ("line", "first"),
    [
        ("sunatlas rec", "recommend"),
        ("sunatlas studies Chang200", "Chang2006"),
        ("sunatlas claims C0", "C01"),
        ("sunatlas recommend --detector CM", "CMOS"),
        ("sunatlas recommend --exclude-extractor Volt", "Voltage\\ balance"),
        ("sunatlas leaderboard --dataset cmos-sin", "cmos-single-aperture"),
        ("sunatlas leaderboard upd", "update"),
        ("sunatlas dataset describe pd-sl", "pd-slit"),
    ],
)
def test_bash_completes_commands_and_names(line, first):
    assert completed(line)[0] == first


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_other_shells_do_too(shell):
    assert "Chang2008" in completed("sunatlas studies Chang200", shell)


def test_what_is_completed_is_what_there_is():
    assert completion.datasets("") == sorted(datasets.names())
    rows = Store(PUBLISHED).rows()
    assert completion.extractors("") == sorted({row["extractor"] for row in rows})
    assert completion.models("") == sorted({row["model"] for row in rows})
    assert sorted(completion.conditions("")) == sorted(
        {row["condition"] for row in rows} - {ON_BENCH}
    )
    assert completion.studies("") == list(facts("all").studies)
    assert completion.values("mask")("") == list(facts().taxonomy.values("mask"))
    assert completion.properties("") == list(facts().properties)
    assert completion.studies("Chang2008") == ["Chang2008"]


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_script_is_one_of_its_shell(shell, tmp_path):
    shown = CliRunner().invoke(app, ["completion", shell])
    assert shown.exit_code == 0
    assert completion.VARIABLE in shown.stdout
    found = shutil.which(shell)
    if found is not None:
        script = tmp_path / "script"
        script.write_text(shown.stdout)
        subprocess.run([found, "-n", script], check=True)


def test_names_are_read_without_importing_what_they_name():
    code = (
        "import sys; from api.cli import completion as c;"
        "c.datasets(''), c.models(''), c.studies(''), c.claims(''), c.values('task')('');"
        "print(*sorted({name.partition('.')[0] for name in sys.modules}))"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "pandas", "fastapi", "algorithms", "registry"} & set(shown.stdout.split())
    assert "studies" in COMMANDS
