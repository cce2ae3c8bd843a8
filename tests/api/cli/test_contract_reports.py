"""The contract of an algorithm: a module that fails is named by file and line, checks by words."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest

from algorithms import extractors
from api.cli import contract
from api.cli.contract import ContractResult, check_contract, name_of
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


def test_checks_that_fail_are_said_in_words_without_the_class_of_error(
    suite: SimpleNamespace, tmp_path: Path
) -> None:
    suite.code = 1
    assert check_contract("direct") == ContractResult(
        4,
        (
            "keeps its input: the input was changed",
            "every class has a docstring: no docstring",
            "it is measured: ",
        ),
    )
    assert suite.cwd == tmp_path
    assert suite.command[-2:] == ["-k", "[direct-check or [direct]"]
    files = [Path(one).name for one in suite.command if one.endswith(".py")]
    assert tuple(files) == contract.SUITE


def test_a_message_longer_than_a_paragraph_is_cut(suite: SimpleNamespace) -> None:
    suite.report = REPORT.replace("was changed", "x" * 1000)
    result = check_contract("direct")
    assert result is not None
    assert result.failures[0] == f"keeps its input: the input {'x' * 290}"


@pytest.mark.parametrize("code", [2, 4, 5])
def test_a_runner_that_ran_nothing_is_a_refusal(suite: SimpleNamespace, code: int) -> None:
    suite.code = code
    with pytest.raises(WrongCallError, match=r"the checks did not run: ERROR: no tests ran$"):
        check_contract("direct")


def test_without_the_test_runner_it_is_said_how_to_get_it(
    suite: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)
    with pytest.raises(WrongCallError, match="need pytest: `make install`"):
        check_contract("direct")
    assert suite.command == []


def test_where_there_are_no_tests_nothing_is_checked(
    suite: SimpleNamespace, tmp_path: Path
) -> None:
    shutil.rmtree(tmp_path / "tests")
    assert check_contract("direct") is None
    assert suite.command == []
