"""`sunatlas figures` prints what the service answers over HTTP."""

import json

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app


def sunatlas(*arguments):
    return CliRunner().invoke(app, ["figures", *arguments])


@pytest.mark.parametrize(
    ("words", "url"),
    [
        (("gap", "--detector", "QPD", "--level", "own"), "gap?detector=QPD&level=own"),
        (("trade-off", "--across", "mass"), "trade-off?across=mass"),
        (
            ("robustness", "--compare", "ppe", "--compare", "slit-image"),
            "robustness?compare=ppe&compare=slit-image",
        ),
    ],
)
def test_a_figure_is_that_of_http_in_every_format(words, url, atlas):
    over_http = atlas.get(f"/v1/figures/{url}").json()
    assert json.loads(sunatlas(*words, "--format", "json").stdout) == over_http
    csv = atlas.get(f"/v1/figures/{url}", "text/csv").text
    assert sunatlas(*words, "--format", "csv").stdout == csv
    table = " ".join(sunatlas(*words).stdout.split())
    assert all(sentence in table for sentence in over_http["text"])


def test_a_wrong_name_is_refused_with_the_nearest():
    shown = sunatlas("robustness", "--compare", "mirror", "--compare", "bctn")
    assert shown.exit_code == 2
    assert "bctm" in shown.stderr
