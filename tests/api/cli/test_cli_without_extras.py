"""Without the packages of the extras, commands that need none work, and the others say so."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from api.cli.command_line import EXTRAS

WITHOUT = """
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {missing!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Missing())
from api.cli.command_line import main
sys.argv = ["sunatlas", *{arguments!r}]
main()
"""


def sunatlas(*arguments: str) -> subprocess.CompletedProcess[str]:
    code = WITHOUT.format(missing=sorted(EXTRAS), arguments=arguments)
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=os.environ, check=False
    )


@pytest.mark.parametrize(
    "arguments",
    [
        ("recommend", "--detector", "CMOS", "--max-error-deg", "0.1"),
        ("studies", "Chang2008"),
        ("leaderboard", "--dataset", "qpd-single-aperture"),
        ("claims", "C29"),
        ("calibrate", "--help"),
        ("survey", "check"),
    ],
    ids=lambda arguments: arguments[0],
)
def test_a_command_needs_the_base_alone(arguments):
    done = sunatlas(*arguments)
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (("serve", "--port", "0"), "serve"),
        (("get", "/v1/claims"), "serve"),
        (("verify", "--sample", "1", "--scheduler", "tcp://127.0.0.1:9"), "cluster"),
        (("deposit", "upload"), "deposit"),
    ],
    ids=lambda each: each if isinstance(each, str) else each[0],
)
def test_a_command_names_the_extra_that_it_needs(arguments, extra):
    done = sunatlas(*arguments)
    assert done.returncode == 1
    assert f"pip install 'sun-sensor-atlas[{extra}]'" in done.stderr
    assert "Traceback" not in done.stderr


def test_calibrating_from_python_needs_the_base_alone():
    code = WITHOUT.partition("from api")[0].format(missing=sorted(EXTRAS))
    done = subprocess.run(
        [sys.executable, "-c", code + "from calibrate import calibrate; print(calibrate.__name__)"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.stdout == "calibrate\n", done.stderr
