"""Without the packages of the extras, commands that need none work, and the others say so."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

from api.cli.command_line import EXTRAS

#: Runs commands one after another in one process, as it is where no extra is installed.
WITHOUT = """
import contextlib, io, json, sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {missing!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Missing())
from calibrate import calibrate
from api.cli.command_line import main

ended = []
for arguments in {commands!r}:
    sys.argv = ["sunatlas", *arguments]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
            code = 0
        except SystemExit as ending:
            code = ending.code or 0
    ended.append((code, out.getvalue(), err.getvalue()))
print(json.dumps(ended))
"""
ALONE = [
    ["recommend", "--detector", "CMOS", "--max-error-deg", "0.1"],
    ["claims", "C29"],
    ["calibrate", "--help"],
    ["survey", "check"],
]
NEEDING = {
    "serve": ["get", "/v1/claims"],
    "cluster": ["verify", "--sample", "1", "--scheduler", "tcp://127.0.0.1:9"],
    "deposit": ["deposit", "upload"],
}


@pytest.fixture(scope="module")
def ended() -> list[tuple[int, str, str]]:
    """Exit code and output of each command, and `calibrate` imported before."""
    code = WITHOUT.format(missing=sorted(EXTRAS), commands=[*ALONE, *NEEDING.values()])
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [tuple(one) for one in json.loads(done.stdout)]


@pytest.mark.parametrize("at", range(len(ALONE)), ids=[one[0] for one in ALONE])
def test_a_command_needs_the_base_alone(ended, at):
    code, out, err = ended[at]
    assert (code, bool(out)) == (0, True), err


@pytest.mark.parametrize("extra", NEEDING)
def test_a_command_names_the_extra_that_it_needs(ended, extra):
    code, _, err = ended[len(ALONE) + list(NEEDING).index(extra)]
    assert code == 1
    assert f"pip install 'sun-sensor-atlas[{extra}]'" in err
    assert "Traceback" not in err
