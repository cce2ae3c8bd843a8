"""`sunatlas assess`, /v1/assessment and /v1/sweeps: the same verdicts, however they are asked."""

from __future__ import annotations

import pytest

from algorithms.discovery import discover_extractors
from api.server.app import create_app
from api.service.knowledge import Knowledge
from api.service.measurements import Measurements
from benchmark.experiments.sweeps import Sweeps
from benchmark.plan.parts import Parts
from benchmark.progress import silent
from benchmark.running.experiment import update
from benchmark.sweeps.record import swept as stored_rows


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    directory = tmp_path_factory.mktemp("published")
    known = discover_extractors()
    few = {name: known[name] for name in ("voltage-balance", "direct")}
    update(Sweeps(directory, Parts({}, few, {})), 1, silent)
    return directory


@pytest.fixture(scope="module")
def swept(published, client_of):
    return client_of(create_app(Knowledge(Measurements(published))))


def test_sweeps_are_served_page_by_page_and_filtered(swept, published):
    stored = stored_rows(published)
    assert swept.walk("/v1/sweeps?limit=7") == stored
    noise = swept.walk("/v1/sweeps?sweep=noise&extractor=direct")
    assert [row["value"] for row in noise] == [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0]
    rows = swept.table("/v1/sweeps?series=quadrants")
    assert {row["extractor"] for row in rows} == {"voltage-balance"}
    assert [float(row["bound"]) for row in rows] == [
        row["bound"] for row in stored if row["series"] == "quadrants"
    ]


def test_what_is_measured_reaches_the_answer(swept):
    (method,) = swept.get("/v1/assessment?method=Voltage%20Balance").json()["methods"]
    found = {verdict["property"]: verdict for verdict in method["properties"]}
    precise = found["High precision"]
    assert (precise["measured"], precise["agreement"]) == (2, "opposed")
    assert precise["value"] == pytest.approx(1.0, abs=0.1)
    assert found["Feature tracking"]["measured"] is None
    assert "tracking" in found["Feature tracking"]["reason"]
