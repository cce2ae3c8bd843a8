"""The issue form and its template: whatever stands in an issue is data and nothing else."""

from __future__ import annotations

import json
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

from survey_data.additions.issue_form import form, main, template_of
from survey_data.additions.offered import FaultsError, parse_toml, read_addition
from tests.survey_data.additions.offered_study import STUDY

ROOT = Path(__file__).parents[3]
FILE = ROOT / ".github" / "ISSUE_TEMPLATE" / "study.yml"
WORKFLOW = ROOT / ".github" / "workflows" / "study.yml"


def event(text: str, end: str = "\n") -> dict[str, object]:
    """GitHub's data of an issue whose form has this text."""
    body = f"### The study\n\n```toml\n{text}```".replace("\n", end)
    return {"action": "opened", "issue": {"body": body}}


def test_the_form_is_the_one_that_is_made_from_the_tables(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert FILE.read_text("utf-8") == form()
    assert main(["--form"]) == 0
    assert capsys.readouterr().out == form()
    (_, field) = yaml.safe_load(form())["body"]
    empty = field["attributes"]["value"]
    assert template_of(event(empty)) == empty
    assert len(empty) < 20_000, "an issue has room for 65,536"


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_filled_form_is_a_study(end: str) -> None:
    addition = read_addition(parse_toml(template_of(event(STUDY, end)), "issue"))
    assert addition.study["authors"] == "Jane Doe; Łukasz Müller"
    fenced = STUDY + '[[task]]\nvalue = "Cost"\nbasis = "title"\nnote = """\n```\n"""\n'
    addition = read_addition(parse_toml(template_of(event(fenced)), "issue"))
    assert "Cost" in {row["value"] for row in addition.rows["attributes"]}


HOSTILE = (
    '"; $(touch owned); `touch owned`; ${{ github.token }} && touch owned #',
    "'''\n\"\"\"\n\\u0000 \\x",
    "../../../etc/passwd\x00\x1b[31m\u202e\u2028",
    "@everyone ](javascript:alert(1)) <script>alert(1)</script> =HYPERLINK()",
    "```\n```toml\n",
)


@pytest.mark.parametrize("words", HOSTILE)
def test_hostile_words_stay_in_their_own_cell_or_are_refused(words: str) -> None:
    for place in ("chapter 3", "A sun sensor that nobody built", "graph network"):
        text = STUDY.replace(place, words)
        assert text != STUDY
        try:
            addition = read_addition(parse_toml(template_of(event(text)), "issue"))
        except FaultsError:
            continue
        models = {r["value"] for r in addition.rows["attributes"] if r["attribute"] == "model"}
        assert (addition.key, models) == ("Doe2030", {"DNN"})


@pytest.mark.parametrize(
    "text",
    [
        *("[]", "{}", '{"issue": {"body": null}}', '{"issue": {"body": "hello"}}', "{", "\xff"),
        json.dumps(event("x = '\ud800'\n")),
        json.dumps(event("#" * 70_000)),
    ],
)
def test_an_event_without_a_study_is_refused_in_words(tmp_path: Path, text: str) -> None:
    path, made = tmp_path / "event.json", tmp_path / "study.toml"
    path.write_bytes(text.encode("latin-1"))
    assert main([str(path), str(made)]) == 1
    assert not made.exists()


def test_the_job_reads_an_event_and_writes_the_template(tmp_path: Path) -> None:
    path, made = tmp_path / "event.json", tmp_path / "study.toml"
    path.write_text(json.dumps(event(STUDY)), "utf-8")
    assert main([str(path), str(made)]) == 0
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
