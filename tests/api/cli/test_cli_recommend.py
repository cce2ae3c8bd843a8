"""`sunatlas recommend`: the service's answer, and the same as text."""

import json
import re

from typer.testing import CliRunner

from api.cli.command_line import app

ASKED = {
    "task": ["Accuracy", "FOV"],
    "exclude_mask": ["Slit"],
    "min_fov_deg": 60,
    "min_availability": 0.9,
    "tolerate": ["albedo", "noise"],
    "properties": ["Robust to noise"],
    "sort": "error",
    "limit": 3,
    "include": ["calibrations"],
    "calibrations": 2,
}


def sunatlas(*arguments):
    return CliRunner().invoke(app, ["recommend", *map(str, arguments)], catch_exceptions=False)


def options(asked):
    for name, value in asked.items():
        for one in value if isinstance(value, list) else [value]:
            yield from (f"--{name.replace('_', '-')}", one)


def text(*arguments):
    shown = sunatlas(*arguments)
    assert shown.exit_code == 0, shown.stderr
    return shown.stdout


def words(shown):
    """Return a text with every run of spaces and line ends as one space."""
    return " ".join(shown.split())


def blocks(shown):
    """Return the lines of each architecture: its own first."""
    return [block.splitlines() for block in re.split(r"\n\n(?=\d)", shown)[1:]]


def test_the_json_is_the_answer_of_the_service_to_the_same_question(atlas):
    served = atlas.get("/v1/recommendations", params=ASKED)
    assert served.status_code == 200
    assert json.loads(text(*options(ASKED), "--format", "json")) == served.json()
    assert served.json()["count"] > 0
    assert sum(1 for _ in served.json()["architectures"]) == 3


def test_each_architecture_shows_its_evidence_in_lines_of_its_own(atlas):
    answer = atlas.get("/v1/recommendations?task=Accuracy&tolerate=albedo&limit=500").json()
    found = blocks(text("--task", "Accuracy", "--tolerate", "albedo", "--limit", 500))
    assert len(found) == answer["count"] > 5
    for lines, architecture in zip(found, answer["architectures"], strict=True):
        rank = f"{architecture['rank']}{'=' if architecture['tied'] else ''}"
        named = [rank, architecture["detector"], "+", f"{architecture['mask']},"]
        assert lines[0].split()[:4] == named
        said = words(" ".join(lines))
        assert words(architecture["reason"]) in said
        for one in architecture["evidence"]:
            assert f"{one['requirement']}: reported {one['reported']}" in said
        for one in architecture["advised"]:
            assert f"{one['value']}: {one['how']} ({one['section_name']})" in said
