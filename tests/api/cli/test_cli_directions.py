"""`sunatlas directions`: a laser's sensors, in every form."""

import json

from typer.testing import CliRunner

from api.cli.command_line import app
from benchmark.experiments.spoofing import SENSORS


def sunatlas(*arguments):
    shown = CliRunner().invoke(app, ["directions", *arguments])
    assert shown.exit_code == 0, shown.stderr
    return shown.stdout


def test_the_direction_of_lasers_has_a_row_a_pipeline_within_its_interval():
    one = json.loads(sunatlas("D12", "--format", "json"))
    assert one["verdict"] != "not tried"
    assert one["experiment"] == "spoofing"
    assert {row["dataset"] for row in one["sensors"]} <= set(SENSORS)
    for row in one["sensors"]:
        assert row["noticed_low"] <= row["noticed"] <= row["noticed_high"]
    assert sunatlas("D12", "--format", "csv").count("\n") == len(one["sensors"]) + 1
    assert "laser" in sunatlas("D12")
