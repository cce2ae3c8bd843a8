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
ALONE = [["claims", "C29"], ["calibrate", "--help"]]
#: Those that read and check whole tables: seconds each.
LONG = [["recommend", "--detector", "CMOS", "--max-error-deg", "0.1"], ["survey", "check"]]
CLUSTER = ["verify", "--sample", "1", "--scheduler", "tcp://127.0.0.1:9"]
NEEDING = (["get", "/v1/claims"], ["deposit", "upload"])


def endings(*commands: list[str]) -> list[tuple[int, str, str]]:
    """Exit code and output of each command, and `calibrate` imported before."""
    code = WITHOUT.format(missing=sorted(EXTRAS), commands=list(commands))
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [tuple(one) for one in json.loads(done.stdout)]


def require_named(extra: str, ended: tuple[int, str, str]) -> None:
    code, _, err = ended
    assert code == 1
    assert f"pip install 'sun-sensor-atlas[{extra}]'" in err
    assert "Traceback" not in err


def test_commands_work_with_the_base_alone_or_name_the_extra_that_they_need():
    *alone, serve, deposit = endings(*ALONE, *NEEDING)
    assert [(code, bool(out)) for code, out, _ in alone] == [(0, True)] * len(ALONE), alone
    require_named("serve", serve)
    require_named("deposit", deposit)


@pytest.mark.slow
def test_so_do_commands_that_take_long():
    *alone, cluster = endings(*LONG, CLUSTER)
    assert [(code, bool(out)) for code, out, _ in alone] == [(0, True)] * len(LONG), alone
    require_named("cluster", cluster)
