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


def sunatlas(*arguments, wide=None):
    env = None if wide is None else {"COLUMNS": str(wide)}
    asked = ["recommend", *map(str, arguments)]
    return CliRunner().invoke(app, asked, catch_exceptions=False, env=env)


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


def test_the_text_says_what_the_json_has(atlas):
    """But for line breaks."""
    found = atlas.get("/v1/recommendations", params=ASKED).json()
    said = " ".join(sunatlas(*options(ASKED), wide=300).stdout.split())
    assert said.startswith(f"first 3 of {found['count']} architectures, {found['designs']} cal")
    assert " ".join(found["order"].split()) in said
    for note in found["notes"]:
        assert f"note {' '.join(note.split())}" in said
    for one in found["architectures"]:
        by = " and ".join(
            {"reported": "reports", "measured": "measurement"}[m] for m in one["meets"]
        )
        tie = "=" if one["tied"] else ""
        assert f"{one['rank']}{tie} {one['detector']} + {one['mask']}, by {by}" in said
        assert f"why {' '.join(one['reason'].split())}" in said
        studies = f"{one['studies']} {'study' if one['studies'] == 1 else 'studies'}"
        products = f"{one['products']} product{'' if one['products'] == 1 else 's'}"
        assert f"built {studies}, {products}" in said
        for advice in one["advised"]:
            assert f"advised {advice['value']}" in said
        for rank, each in enumerate(one["calibrations"], start=1):
            row = said.partition(f" {rank} {each['name']} ")[2]
            users = str(len(each["studies"])) if each["studies"] else "none"
            assert f" {'yes' if each['advised'] else 'no'} {users} " in row
            if each["measured"] and (own := each["measured"]["own_error_deg"]):
                assert f" {own:.3g} over " in row
        rest = one["count"] - len(one["calibrations"])
        assert (f"... and {rest} more" in said) or not rest


def test_what_nothing_meets_is_explained_with_what_would_help(atlas):
    asked = {"detector": "QPD", "max_error_deg": 1e-6}
    blocked = atlas.get("/v1/recommendations", params=asked).json()["blocked"]
    shown = sunatlas("--detector", "QPD", "--max-error-deg", 1e-6)
    said = " ".join((shown.stdout + shown.stderr).split())
    assert "no architecture meets the requirements" in said
    assert " ".join(blocked["detail"].split()) in said
    assert blocked["relaxations"]
    for one in blocked["relaxations"]:
        count = one["architectures"]
        assert f"{one['words']}: {count} architecture{'' if count == 1 else 's'}" in said
