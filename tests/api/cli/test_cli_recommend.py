"""`sunatlas recommend`: the service's answer, and the same as text."""

import json

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


def test_the_json_is_the_answer_of_the_service_to_the_same_question(atlas):
    served = atlas.get("/v1/recommendations", params=ASKED)
    assert served.status_code == 200
    assert json.loads(text(*options(ASKED), "--format", "json")) == served.json()
    assert served.json()["count"] > 0
    assert sum(1 for _ in served.json()["architectures"]) == 3
