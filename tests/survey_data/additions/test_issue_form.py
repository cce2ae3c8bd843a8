"""The issue form and its template: whatever stands in an issue is data and nothing else."""

from __future__ import annotations

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from survey_data.additions.addition_reader import read_addition
from survey_data.additions.faults import FaultsError
from survey_data.additions.issue_form import form, main, template_of
from survey_data.additions.toml_lines import parse_toml
from survey_data.additions.vocabulary import Vocabulary, vocabulary

ROOT = Path(__file__).parents[3]
FILE = ROOT / ".github" / "ISSUE_TEMPLATE" / "study.yml"
WORKFLOW = ROOT / ".github" / "workflows" / "study.yml"

KNOWN = vocabulary()
FILLED = {
    "Key": "Doe2030",
    "Title": "A sun sensor that nobody built",
    "Authors": "Jane Doe; Max Müller",
    "Year": "2030",
    "DOI": "10.1234/made.up",
    "Kind of publication": "preprint",
    "How sure is the publication": "confirmed",
    "Model representation": "DNN [proposed] (nearest to: a net (sparse)) | abstract | "
    "10.1234/made.up | one | two\nICM/Albedo | title",
    "Detector": "CMOS (in the study: APS) | title",
    "Reported accuracy": "0.005 | abstract | 10.1234/made.up | mean error",
}


@pytest.fixture(scope="module")
def known() -> Vocabulary:
    return vocabulary()


def labels() -> list[str]:
    fields = yaml.safe_load(FILE.read_text("utf-8"))["body"]
    return [each["attributes"]["label"] for each in fields if each["type"] != "markdown"]


def body(filled: dict[str, str], end: str = "\n") -> str:
    """The body of an issue, as GitHub writes it."""
    parts = [f"### {label}\n\n{filled.get(label) or '_No response_'}" for label in labels()]
    return "\n\n".join(parts).replace("\n", end)


def test_the_form_is_the_one_that_is_made_from_the_tables(known: Vocabulary) -> None:
    assert FILE.read_text("utf-8") == form(known)
    assert len(set(labels())) == len(labels())


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_filled_form_is_a_study(known: Vocabulary, end: str) -> None:
    text = template_of(body(FILLED, end), known)
    addition = read_addition(parse_toml(text, "issue"), known)
    assert addition.study["authors"] == "Jane Doe; Max Müller"
    assert addition.study["type"] == "preprint"
    cells = {(row["attribute"], row["value"]): row for row in addition.rows["attributes"]}
    assert cells["model", "DNN"]["note"] == "one | two"
    assert cells["accuracy_deg", "0.005"]["basis"] == "abstract"
    assert cells["mask", ""]["basis"] == "unknown"
    assert [(row["name"], row["nearest"]) for row in addition.rows["names"]] == [
        ("a net (sparse)", "true"),
        ("APS", "false"),
    ]
    assert [(row["value"], row["role"]) for row in addition.rows["roles"]] == [("DNN", "proposed")]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "headings of the form are missing"),
        ("hello\n### Key\n\nDoe2030", "missing: ### Title"),
        (body({**FILLED, "Title": "x\n\n### Key\n\nRoe2030"}), "'### Key' stands twice"),
        ("x" * 70_000, "longer than 65536"),
    ],
)
def test_what_was_not_made_with_the_form_is_refused(
    known: Vocabulary, text: str, said: str
) -> None:
    with pytest.raises(FaultsError, match=said):
        template_of(text, known)


HOSTILE = (
    '"; $(touch owned); `touch owned`; ${{ github.token }} && touch owned #',
    'x"\n[[model]]\nvalue = "LUT"\nbasis = "title',
    "'''\n\"\"\"\n\\u0000 \\x",
    "../../../etc/passwd\x00\x1b[31m\u202e\u2028",
    "@everyone ](javascript:alert(1)) <script>alert(1)</script> =HYPERLINK()",
    "(nearest to:" * 4000,
    " | ".join("x" * 2000),
)


@pytest.mark.parametrize("words", HOSTILE)
def test_hostile_words_stay_in_their_own_cell_or_are_refused(known: Vocabulary, words: str) -> None:
    for label in labels():
        try:
            text = template_of(body({**FILLED, label: words}), known)
            addition = read_addition(parse_toml(text, "issue"), known)
        except FaultsError:
            continue
        assert addition.key == "Doe2030", label
        models = {r["value"] for r in addition.rows["attributes"] if r["attribute"] == "model"}
        assert models == {"DNN", "ICM/Albedo"}, label  # nothing was smuggled in


@given(st.dictionaries(st.sampled_from(labels()), st.text(max_size=60)))
def test_any_words_give_a_template_of_texts_or_a_refusal(words: dict[str, str]) -> None:
    try:
        values = tomllib.loads(template_of(body(words), KNOWN))
    except (FaultsError, tomllib.TOMLDecodeError):
        return  # a character that TOML does not have is refused by line where it is read
    for value in values.values():
        for each in value if isinstance(value, list) else [value]:
            cells = each.values() if isinstance(each, dict) else [each]
            assert all(isinstance(cell, str) or cell is True for cell in cells)


@pytest.mark.parametrize(
    "event",
    ["[]", "{}", '{"issue": {"body": null}}', '{"issue": {"body": "\\ud800"}}', "{", "\xff"],
)
def test_an_event_without_a_body_is_refused_in_words(tmp_path: Path, event: str) -> None:
    path, made = tmp_path / "event.json", tmp_path / "study.toml"
    path.write_bytes(event.encode("latin-1"))
    assert main([str(path), str(made)]) == 1
    assert not made.exists()


def test_the_job_reads_an_event_and_writes_the_template(tmp_path: Path) -> None:
    path, made = tmp_path / "event.json", tmp_path / "study.toml"
    path.write_text(json.dumps({"issue": {"body": body(FILLED)}}), "utf-8")
    command = [sys.executable, "-m", "survey_data.additions.issue_form", str(path), str(made)]
    subprocess.run(command, cwd=ROOT, check=True)
    assert tomllib.loads(made.read_text("utf-8"))["key"] == "Doe2030"


def test_the_workflow_puts_nothing_of_an_issue_into_a_command() -> None:
    text = WORKFLOW.read_text("utf-8")
    jobs = yaml.safe_load(text)["jobs"]
    assert yaml.safe_load(text)["permissions"] == {}
    assert jobs["read"]["permissions"] == {"contents": "read"}
    for job in jobs.values():
        for step in job["steps"]:
            assert "${{" not in step.get("run", "")
    for said in ("issue.body", "issue.title", "issue.user", "pull_request_target"):
        assert said not in text
    for script in ("answer-study", "offer-study"):
        subprocess.run(["bash", "-n", str(ROOT / ".ci" / script)], check=True)
