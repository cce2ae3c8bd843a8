"""CSV of the command line is that of the service, byte for byte."""

import csv
import io

import pytest
from typer.testing import CliRunner

from api import columns
from api.cli.command_line import app

TWINS = (
    (("studies",), "/v1/studies?limit=500", columns.STUDIES),
    (("studies", "--detector", "Event"), "/v1/studies?detector=Event&limit=500", columns.STUDIES),
    (("studies", "--q", "no such words"), "/v1/studies?q=no+such+words", columns.STUDIES),
    (("studies", "Chang2008"), "/v1/studies/Chang2008", columns.STUDY),
    (("recommend",), "/v1/recommendations", columns.RECOMMENDATIONS),
    (
        ("recommend", "--survive", "albedo", "--task", "Accuracy", "--limit", "3"),
        "/v1/recommendations?survive=albedo&task=Accuracy&limit=3",
        columns.RECOMMENDATIONS,
    ),
    (
        ("recommend", "--detector", "Event", "--mask", "Lens"),
        "/v1/recommendations?detector=Event&mask=Lens",
        columns.RECOMMENDATIONS,
    ),
    (("leaderboard",), "/v1/leaderboard/architectures?limit=500", columns.ARCHITECTURES),
    (("leaderboard", "--overview"), "/v1/leaderboard/overview", columns.PARTS),
    (
        ("leaderboard", "--dataset", "pd-slit"),
        "/v1/leaderboard/pd-slit?limit=500",
        columns.LEADERBOARD,
    ),
    (
        ("leaderboard", "--dataset", "pd-slit", "--condition", "hot"),
        "/v1/leaderboard/pd-slit?condition=hot&limit=500",
        columns.LEADERBOARD,
    ),
    (
        ("benchmark", "--dataset", "pd-slit", "--condition", "nominal"),
        "/v1/results?dataset=pd-slit&condition=nominal&limit=500",
        columns.RESULTS,
    ),
    (("claims",), "/v1/claims?limit=500", columns.CLAIMS),
    (("claims", "C04"), "/v1/claims/C04", columns.CLAIM),
    (("curves",), "/v1/curves?limit=500", columns.CURVES),
    (("assess",), "/v1/assessment", columns.ASSESSMENT),
    (("assess", "--method", "BCM"), "/v1/assessment?method=BCM", columns.ASSESSMENT),
    (("dataset", "list"), "/v1/datasets?limit=500", columns.DATASETS),
    (("dataset", "describe", "pd-slit"), "/v1/datasets/pd-slit", columns.DATASET),
    (("dataset", "realism"), "/v1/realism", columns.REALISM),
    (("get", "/v1/taxonomy"), "/v1/taxonomy", columns.TAXONOMY),
    (("get", "/v1/flows/error"), "/v1/flows/error", columns.FLOWS),
    (("get", "/v1/algorithms?limit=500"), "/v1/algorithms?limit=500", columns.ALGORITHMS),
    (("get", "/v1/search?q=centroid"), "/v1/search?q=centroid", columns.SEARCH),
    (("get", "/v1/advice"), "/v1/advice", columns.ADVICE),
    (("get", "/v1/protocol"), "/v1/protocol", columns.PROTOCOL),
    (("get", "v1/sweeps?extractor=bcm"), "/v1/sweeps?extractor=bcm", columns.SWEEPS),
)


def shown(*arguments):
    found = CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert found.exit_code == 0, found.stderr
    return found.stdout_bytes


@pytest.mark.parametrize(("arguments", "address", "names"), TWINS)
def test_command_line_and_service_agree_byte_for_byte(atlas, arguments, address, names):
    ours = shown(*arguments, "--format", "csv")
    assert ours == atlas.get(address, accept="text/csv").content
    assert tuple(next(csv.reader(io.StringIO(ours.decode())))) == names


def test_json_of_an_address_is_the_service_s_too(atlas):
    assert shown("get", "/v1/flows/task", "--format", "json").rstrip(b"\n") == (
        atlas.get("/v1/flows/task").content
    )


@pytest.mark.parametrize(
    ("address", "says"),
    [
        ("/v1/flows/eror", "the nearest is 'error'"),
        ("/v1/studies?detektor=CMOS", "the nearest is 'detector'"),
        ("/nowhere", "/nowhere: "),
    ],
)
def test_an_address_that_is_none_is_refused_in_a_line(address, says):
    refused = CliRunner().invoke(app, ["get", address])
    assert refused.exit_code == 2
    assert refused.stdout == ""
    assert refused.stderr.count("\n") == 1
    assert says in refused.stderr
