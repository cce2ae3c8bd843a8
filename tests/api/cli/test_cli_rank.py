"""`sunatlas rank`: an algorithm checked, measured and shown among the others."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from typer.testing import CliRunner

from api.cli import contract
from api.cli.command_line import app
from api.cli.contract import ContractResult, name_of
from api.cli.wrong_call import WrongCallError
from benchmark.contract import UnknownNameError

NAME, DATASET = "voltage-balance", "qpd-single-aperture"


def test_an_algorithm_is_named_by_its_name_or_by_its_file(tmp_path: Path) -> None:
    assert name_of(NAME) == NAME
    folder = contract.ROOT / "algorithms"
    assert (
        name_of(str(folder / "extractors" / "profiles" / "eigen_analysis.py")) == "eigen-analysis"
    )
    with pytest.raises(UnknownNameError, match=NAME):
        name_of("voltage-balanse")
    with pytest.raises(WrongCallError, match="no such file"):
        name_of(str(tmp_path / "none.py"))
    with pytest.raises(WrongCallError, match="one of them"):
        name_of(str(folder / "extractors" / "currents" / "photodiode.py"))
    with pytest.raises(WrongCallError, match="no public class"):
        name_of(str(folder / "angles.py"))


@pytest.mark.slow
def test_the_checks_of_the_contract_are_those_of_the_common_suite() -> None:
    result = contract.check_contract(NAME)
    assert result is not None
    assert result.failures == ()
    assert result.ran > 10


@pytest.mark.slow
def test_an_algorithm_is_shown_on_the_board_of_a_data_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("api.cli.commands.rank.check_contract", lambda _: ContractResult(12, ()))
    asked = ["rank", NAME, "--dataset", DATASET, "--store", str(tmp_path / "store")]
    answer = CliRunner().invoke(app, [*asked, "--format", "json"])
    assert answer.exit_code == 0, answer.output
    assert "12 checks passed" in answer.stderr
    rows = json.loads(answer.stdout)["items"]
    assert {row["extractor"] for row in rows if row["new"]} == {NAME}
    assert {row["dataset"] for row in rows} == {DATASET}


def test_a_check_that_fails_is_told_in_its_own_words() -> None:
    suite = """<testsuite>
      <testcase name="test_extractor[bctm-check_rows_are_alone]"><failure
        message="AssertionError: row 3
        differs"/></testcase>
      <testcase name="test_every_one_has_a_label"><error message="KeyError: 'BCTM'"/></testcase>
      <testcase name="test_model[lut-check_nothing]"/>
    </testsuite>"""
    assert list(contract._failures(list(ET.fromstring(suite)))) == [
        "rows are alone: row 3 differs",
        "every one has a label: 'BCTM'",
    ]
