"""Refusals say what came and what is expected, in words and not in those of the machinery."""

import re

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.results.store import PUBLISHED

#: A dictionary, a list, a class or the words of a library.
MACHINERY = re.compile(r"\{'|\['|<class|Error\b|Exception|Traceback|Input should|pydantic|None\b")


def invoke(*arguments):
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


@pytest.fixture
def odd(tmp_path):
    """A directory with what is not what commands expect."""
    (tmp_path / "file").write_text("x,y\n")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "empty").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("call", "code", "says"),
    [
        ("nothing", 2, r"'nothing'.*`sunatlas --help`"),
        ("serve --port x", 2, r"--port: .*'x'.*integer"),
        ("studies --format xml", 2, r"--format: .*'xml'.*'table', 'json', 'csv'"),
        ("studies --year-min 99999", 2, r"--year-min: .*99999.*\b0\b"),
        ("studies Chag2008", 2, r"'Chag2008'.*'Chang2008'"),
        ("recommend --max-error-deg nan", 2, r"--max-error-deg: .*\bnan\b.*\b0\b.*\b180\b"),
        ("recommend --properties robust", 2, r"--properties: .*'robust'.*'Robust"),
        ("claims --verdict refutd", 2, r"--verdict: .*'refutd'.*'refuted'"),
        ("claims C04 --search x", 2, "an ID stands alone"),
        ("compare", 2, "dataset: expected a data set with its pipelines"),
        ("recommend --mission leo", 2, "--mission: .*leo-cubesat"),
        ("get /v1/flows/eror", 2, "the nearest is 'error'"),
        ("run Chang2008 --suite quick", 2, "study's key and --suite"),
        ("run Allgeier2009 --condition nominale", 1, "'nominal'"),
        ("verify --sample 0", 2, "--sample: got '0'"),
        (f"gc --store {PUBLISHED}", 2, "`sunatlas leaderboard`"),
        ("deposit publish", 2, "record_id"),
        ("deposit upload --production --server https://a.example", 2, "give one"),
        ("survey import {odd}/file --map =detector", 2, "--map: .*COL=ATTRIBUTE"),
        ("plan --store {odd}/file", 2, r"--store: {odd}/file\b.*directory"),
        ("benchmark --dataset pd-slit --extractor bcm", 1, r"pd-slit, bcm: .*frames"),
        ("leaderboard --dataset ccd-orbt", 1, r"did you mean 'ccd-orbit'\?"),
        ("leaderboard --detector QPD --mask Slit", 2, "nothing is published of such"),
        ("dataset export pd-slit --out x --condition nominl", 1, "'nominal'"),
        ("dataset preview ccd-lens --out x --overlay hough-line", 1, "'hough-lines'"),
        ("dataset albedo pd-maskless-pyramid", 1, "no cube"),
        ("rank {odd}/nothing.py --dataset pd-slit", 2, r"{odd}/nothing\.py: no such file"),
        ("survey check --data {odd}/file", 1, "directory"),
        ("survey add", 2, "expected a file, or --init KEY for a template"),
        ("survey import {odd}/file --map a", 2, r"--map: .*COL=ATTRIBUTE.*'a'"),
        ("survey import {odd}/bytes.csv", 1, r"bytes\.csv\b.*UTF-8"),
        ("dataset export pd-slit --out {odd}/file", 1, r"{odd}/file: .*directory"),
        ("dataset preview pd-slit --out /proc/x.png", 1, "/proc: "),
        ("deposit verify {odd}/empty", 1, "not a bundle"),
    ],
)
def test_a_refusal_is_a_line_in_the_words_of_who_asked(odd, call, code, says):
    refused = invoke(*call.replace("{odd}", str(odd)).split())
    assert refused.exit_code == code
    assert refused.stdout == ""
    assert refused.stderr.startswith("sunatlas: ")
    assert refused.stderr.count("\n") == 1
    assert re.search(says.replace("{odd}", re.escape(str(odd))), refused.stderr)
    assert not MACHINERY.search(refused.stderr)


def test_options_that_are_not_met_by_one_value_are_each_named():
    refused = invoke("curves", "--extractor", "bmc", "--model", "lsqq")
    assert refused.exit_code == 2
    assert "--extractor: no 'bmc'" in refused.stderr
    assert "--model: no 'lsqq'" in refused.stderr
