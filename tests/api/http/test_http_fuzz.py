"""Fuzzed from its own OpenAPI document, the service refuses with problems and never fails."""

import json

import hypothesis
import pytest
import schemathesis
from schemathesis import GenerationMode
from schemathesis.config import SchemathesisConfig

from api.server.app import ROUTES

#: Every documented path, with the methods that it takes.
OPERATIONS = [
    (method, route.path)
    for route in ROUTES
    if route.include_in_schema
    for method in sorted(route.methods - {"HEAD"})
]
PLAIN = {"/healthz", "/v1/leaderboard/croissant.json", "/v1/leaderboard/linkset.json"}
# Nothing but `format` can be asked for, and so little else be right.
ONLY_FORMAT = {"/v1/figures", "/v1/taxonomy", "/v1/protocol"}
# No schema tells which bytes are readings: tests of calibrations upload right ones.
UPLOADS = {"/v1/calibrations", "/v1/calibrations/preview"}
# A cursor cannot be distinguished from its schema: one that was never given out is a 400 (see the
# check).
ACCEPTED = ["2xx", "304", "400"]
CONFIG = {
    "generation": {"mode": "all", "deterministic": True},
    "checks": {"positive_data_acceptance": {"expected-statuses": ACCEPTED}},
}


@pytest.fixture(scope="module")
def api(atlas):
    config = SchemathesisConfig.from_dict(CONFIG)
    return schemathesis.openapi.from_asgi("/openapi.json", atlas.app, config=config)


def refused_by_problem(context, response, case):
    """A 4xx is a problem document about itself; nothing is a 5xx."""
    assert response.status_code < 500, response.text
    if response.status_code < 400:
        return
    assert response.headers["content-type"] == ["application/problem+json"]
    document = json.loads(response.content)
    assert document["status"] == response.status_code
    assert document["type"].startswith("urn:problem-type:sun-sensor-atlas:")
    assert document["detail"]
    if case.meta.generation.mode is GenerationMode.POSITIVE:
        # What a schema cannot tell: which pipelines are scored on a data set, what goes together.
        unsaid = (":invalid-cursor", ":not-comparable", ":not-combinable")
        assert document["type"].endswith(unsaid)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("method", "path", "mode"),
    [
        (*operation, mode)
        for operation in OPERATIONS
        for mode in (GenerationMode.POSITIVE, GenerationMode.NEGATIVE)
        # Nothing can be wrong with a question that has no parameters.
        if operation[1] not in (UPLOADS if mode is GenerationMode.POSITIVE else PLAIN)
    ],
)
def test_any_request_is_answered_as_documented_or_refused(api, method, path, mode):
    asked = []
    # a picture is rendered
    most, fewest = (8, 4) if path.endswith(".png") else (40, 20)

    @hypothesis.given(api[path][method].as_strategy(generation_mode=mode))
    @hypothesis.settings(
        max_examples=most,
        deadline=None,
        derandomize=True,
        database=None,
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    def fuzz(case):
        asked.append(case)
        case.call_and_validate(additional_checks=[refused_by_problem])

    fuzz()
    few = path in ONLY_FORMAT and mode is GenerationMode.POSITIVE
    assert len(asked) >= (1 if path in PLAIN else 3 if few else fewest)
