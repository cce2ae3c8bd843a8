"""Shells complete commands and the names that commands take."""

import shutil
import subprocess

import pytest
from typer.testing import CliRunner

from api.cli import options as completion
from api.cli.command_line import app


def completed(line, shell="bash"):
    """Return what a shell offers behind a line; one that ends in a space begins a word."""
    words = {
        "bash": {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)},
        "zsh": {"_TYPER_COMPLETE_ARGS": line},
        "fish": {"_TYPER_COMPLETE_ARGS": line, "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }[shell]
    asked = {**words, completion.VARIABLE: f"complete_{shell}"}
    shown = CliRunner().invoke(app, [], env=asked, prog_name="sunatlas")
    assert shown.stderr == ""
    return shown.stdout.split("\n")[:-1] if shell == "bash" else shown.stdout


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
