"""Answers of the command line are those of the service: CSV byte for byte, and most JSON."""

import json

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app

#: Calls whose JSON is the service's, too; of the others JSON has more than a page of the service.
ALIKE = (
    ("recommend", "/v1/recommendations"),
    ("leaderboard", "/v1/leaderboard/architectures"),
    ("leaderboard --detector PD", "/v1/leaderboard/architectures?detector=PD"),
    ("leaderboard --mask Slit", "/v1/leaderboard/architectures?mask=Slit"),
    ("leaderboard --overview", "/v1/leaderboard/overview"),
    (
        "leaderboard --overview --detector CCD --detector CMOS --mask Slit",
        "/v1/leaderboard/overview?detector=CCD&detector=CMOS&mask=Slit",
    ),
    ("claims", "/v1/claims"),
    ("assess", "/v1/assessment"),
    ("get /v1/taxonomy", "/v1/taxonomy"),
    ("get /v1/flows/task", "/v1/flows/task"),
    ("get /v1/advice", "/v1/advice"),
    ("get v1/sweeps?extractor=bcm", "/v1/sweeps?extractor=bcm"),
)
TWINS = (
    *ALIKE,
    ("studies", "/v1/studies?limit=500"),
    ("studies Chang2008", "/v1/studies/Chang2008"),
    ("leaderboard --dataset pd-slit", "/v1/leaderboard/pd-slit?limit=500"),
    (
        "benchmark --dataset pd-slit --condition nominal",
        "/v1/results?dataset=pd-slit&condition=nominal&limit=500",
    ),
    ("claims C04", "/v1/claims/C04"),
    ("curves", "/v1/curves?limit=500"),
    ("dataset list", "/v1/datasets?limit=500"),
    ("dataset describe pd-slit", "/v1/datasets/pd-slit"),
    ("dataset realism", "/v1/realism"),
    ("get /v1/protocol", "/v1/protocol"),
)


def shown(call, form):
    found = CliRunner().invoke(app, [*call.split(), "--format", form], catch_exceptions=False)
    assert found.exit_code == 0, found.stderr
    return found.stdout_bytes


@pytest.mark.parametrize(("call", "address"), TWINS)
def test_command_line_and_service_agree_byte_for_byte(atlas, call, address):
    assert shown(call, "csv") == atlas.get(address, accept="text/csv").content
    if (call, address) in ALIKE:
        assert json.loads(shown(call, "json")) == atlas.get(address).json()
