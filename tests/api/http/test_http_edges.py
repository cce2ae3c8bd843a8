"""What the service does at its edges: odd messages, empty lists, other statuses, many workers."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI, HTTPException
from prometheus_client.parser import text_string_to_metric_families
from prometheus_client.values import MultiProcessValue

from api.server.app import create_app
from api.service import calibrations
from api.service.asking import ask
from api.service.knowledge import Knowledge
from api.service.studies import studies
from api.web import observation
from tests.api.conftest import Client


def test_numbers_of_all_workers_are_added_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PROMETHEUS_MULTIPROC_DIR", str(tmp_path))
    for worker, count in ((11, 2.0), (12, 3.0)):
        kept: Any = MultiProcessValue(lambda number=worker: number)  # type: ignore[no-untyped-call]
        labels = (("method", "route", "status"), ("GET", "/v1/x", "200"))
        total = ("sunatlas_http_requests", "sunatlas_http_requests_total")
        value = kept("counter", *total, *labels, "Requests answered.")
        value.inc(count)
        value._file.close()  # else it stays open until a later test fails for it
    found = {
        sample.name: sample.value
        for family in text_string_to_metric_families(observation.exposition().decode())
        for sample in family.samples
    }
    assert found == {"sunatlas_http_requests_total": 5.0}


def test_a_status_of_the_framework_is_a_problem_named_after_it(
    client_of: Callable[[FastAPI], Client],
) -> None:
    app = create_app(Knowledge())

    @app.get("/held")
    async def held() -> None:
        raise HTTPException(409, "held by another", headers={"Retry-After": "3"})

    answer = client_of(app).get("/held")
    assert (answer.status_code, answer.headers["retry-after"]) == (409, "3")
    document = answer.json()
    assert document["type"] == "urn:problem-type:sun-sensor-atlas:conflict"
    assert document["detail"] == "held by another"


def test_a_calibration_is_told_when_to_come_back_where_too_many_wait(
    client_of: Callable[[FastAPI], Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(calibrations._CALIBRATIONS, "length", 9)
    files = {"file": ("b.csv", b"x_px,y_px,alpha,beta\n")}
    answer = client_of(create_app(Knowledge())).post("/v1/calibrations", files=files)
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "90")
    assert answer.json()["detail"] == "9 calibrations run or wait here; try again in 90 s."
    assert answer.json()["type"].endswith(":busy")


@pytest.mark.parametrize("asked", [{"year_min": 0}, {"year_max": 9999}])
def test_a_study_without_a_year_is_in_no_range_of_years(
    asked: dict[str, int], knowledge: Knowledge
) -> None:
    key, study = next(iter(knowledge.facts.studies.items()))
    undated = {key: dataclasses.replace(study, year=None)}
    known = Knowledge(knowledge.measurements)
    vars(known).update(facts=dataclasses.replace(knowledge.facts, studies=undated))
    assert ask(studies, known, query={"key": [key], **asked}).document["items"] == []
