"""CSV of the command line is that of the service, byte for byte."""

import csv
import io

import pytest
from typer.testing import CliRunner

from api.cli.command_line import app
from api.schema.advice import Advice, Statement
from api.schema.assessment import Sweep, VerdictRow
from api.schema.boards import BestOfArchitecture, PartOverview
from api.schema.claims import CheckedRule, ClaimRow
from api.schema.curves import CurveRow
from api.schema.datasets import BuiltSensorRow, Data, Dataset
from api.schema.flows import Link
from api.schema.recommendations import RecommendationRow
from api.schema.scores import LeaderboardRow, Score
from api.schema.studies import AttributeValue, StudyRow
from api.schema.table import columns_of
from api.schema.taxonomy import TaxonomyRow

TWINS = (
    (("studies",), "/v1/studies?limit=500", columns_of(StudyRow)),
    (("studies", "Chang2008"), "/v1/studies/Chang2008", columns_of(AttributeValue)),
    (("recommend",), "/v1/recommendations", columns_of(RecommendationRow)),
    (("leaderboard",), "/v1/leaderboard/architectures?limit=500", columns_of(BestOfArchitecture)),
    (("leaderboard", "--overview"), "/v1/leaderboard/overview", columns_of(PartOverview)),
    (
        ("leaderboard", "--dataset", "pd-slit"),
        "/v1/leaderboard/pd-slit?limit=500",
        columns_of(LeaderboardRow),
    ),
    (
        ("benchmark", "--dataset", "pd-slit", "--condition", "nominal"),
        "/v1/results?dataset=pd-slit&condition=nominal&limit=500",
        columns_of(Score),
    ),
    (("claims",), "/v1/claims?limit=500", columns_of(ClaimRow)),
    (("claims", "C04"), "/v1/claims/C04", columns_of(CheckedRule)),
    (("curves",), "/v1/curves?limit=500", columns_of(CurveRow)),
    (("assess",), "/v1/assessment", columns_of(VerdictRow)),
    (("dataset", "list"), "/v1/datasets?limit=500", columns_of(Dataset)),
    (("dataset", "describe", "pd-slit"), "/v1/datasets/pd-slit", columns_of(Data)),
    (("dataset", "realism"), "/v1/realism", columns_of(BuiltSensorRow)),
    (("get", "/v1/taxonomy"), "/v1/taxonomy", columns_of(TaxonomyRow)),
    (("get", "/v1/flows/error"), "/v1/flows/error", columns_of(Link)),
    (("get", "/v1/advice"), "/v1/advice", columns_of(Advice)),
    (("get", "/v1/protocol"), "/v1/protocol", columns_of(Statement)),
    (("get", "v1/sweeps?extractor=bcm"), "/v1/sweeps?extractor=bcm", columns_of(Sweep)),
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
