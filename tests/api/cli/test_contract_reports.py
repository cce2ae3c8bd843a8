"""The contract of an algorithm: a module that fails is named by file and line, checks by words."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest

from algorithms import extractors
from api.cli import contract
from api.cli.contract import name_of
from api.cli.wrong_call import WrongCallError

REPORT = """\
<testsuites><testsuite>
  <testcase name="test_common[direct-check_is_stateless]"/>
  <testcase name="test_common[direct-check_keeps_its_input]">
    <failure message="AssertionError: the input&#10;  was changed">trace</failure>
  </testcase>
  <testcase name="test_every_class_has_a_docstring[direct]">
    <error message="ValueError: no docstring"/>
  </testcase>
  <testcase name="test_it_is_measured"><failure/></testcase>
</testsuite></testsuites>
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A module of extractors, still to be written, in another checkout."""
    folder = tmp_path / "algorithms" / "extractors"
    folder.mkdir(parents=True)
    monkeypatch.setattr(contract, "ROOT", tmp_path)
    monkeypatch.setattr(extractors, "__path__", [str(folder)])
    yield folder / "new_idea.py"
    sys.modules.pop("algorithms.extractors.new_idea", None)
    vars(extractors).pop("new_idea", None)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("x = 1\ndef f(:\n", r"new_idea\.py, line 2: SyntaxError: "),
        ("import math\n\nmath.sqroot(2)\n", r"^algorithms/extractors/new_idea\.py, line 3: Attrib"),
        (
            "class Half:\n    def extract(self):\n        return 1\n",
            r"^TypeError: .*Half lacks about",
        ),
    ],
)
def test_a_module_that_cannot_be_imported_is_named_with_its_line(
    module: Path, text: str, says: str
) -> None:
    module.write_text(text)
    with pytest.raises(WrongCallError, match=says):
        name_of("direct")


@pytest.fixture
def suite(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """A checkout with a fake test runner, which keeps its command."""
    (tmp_path / "tests" / "algorithms").mkdir(parents=True)
    monkeypatch.setattr(contract, "ROOT", tmp_path)
    told = SimpleNamespace(code=0, report=REPORT, command=[], cwd=None)

    def run(command: Sequence[str], *, cwd: Path, **_: object) -> object:
        told.command, told.cwd = list(command), cwd
        (report,) = (one for one in command if one.startswith("--junitxml="))
        Path(report.partition("=")[2]).write_text(told.report)
        return subprocess.CompletedProcess(command, told.code, "", "ERROR: no tests ran\n")

    monkeypatch.setattr(subprocess, "run", run)
    return told
