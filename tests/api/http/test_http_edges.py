"""What the service does at its edges: odd messages, empty lists, other statuses, many workers."""

from __future__ import annotations

import asyncio
import dataclasses
from collections.abc import Callable, Iterator
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Annotated, Any

import pytest
from fastapi import FastAPI, HTTPException, Query
from prometheus_client.parser import text_string_to_metric_families
from prometheus_client.values import MultiProcessValue
from pydantic import BaseModel, ConfigDict
from starlette.types import Message, Receive, Scope, Send

from api.http.openapi import describe
from api.http.openapi_sharing import inlined
from api.http.reference import target
from api.schema.parameters import OneOf
from api.server import app as service
from api.server import serving
from api.server.app import create_app
from api.service.asking import ask
from api.service.knowledge import Knowledge
from api.service.problems import Problem
from api.service.refusals import refusal
from api.service.studies import studies
from api.web import calibrations, observation, requests
from api.web.answers import Answer, AnswerRoute, Columns
from api.web.dependencies import Known
from api.web.middleware import EveryResponse
from api.web.negotiation import PARQUET
from api.web.representations import Representation, RepresentationCache
from api.web.requests import StrictRequest
from tests.api.conftest import Client


def test_numbers_of_all_workers_are_added_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PROMETHEUS_MULTIPROC_DIR", str(tmp_path))
    for worker, count in ((11, 2.0), (12, 3.0)):
        kept: Any = MultiProcessValue(lambda number=worker: number)  # type: ignore[no-untyped-call]
        labels = (("method", "route", "status"), ("GET", "/v1/x", "200"))
        total = ("sunatlas_http_requests", "sunatlas_http_requests_total")
        kept("counter", *total, *labels, "Requests answered.").inc(count)
    found = {
        sample.name: sample.value
        for family in text_string_to_metric_families(observation.exposition().decode())
        for sample in family.samples
    }
    assert found == {"sunatlas_http_requests_total": 5.0}


@pytest.fixture
def log(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The access log, which a test may set up: it is afterwards as it was."""
    for name in ("handlers", "propagate", "level"):
        monkeypatch.setattr(observation.LOG, name, getattr(observation.LOG, name))
    yield
    monkeypatch.undo()
    observation.LOG.manager._clear_cache()  # type: ignore[attr-defined]


SCOPE: Scope = {"type": "http", "method": "GET", "path": "/x", "query_string": b"", "headers": []}


@pytest.mark.usefixtures("log")
@pytest.mark.parametrize("wanted", ["", "yes"])
def test_requests_are_written_to_standard_output_where_the_environment_asks_for_it(
    wanted: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(serving.ACCESS_LOG, wanted)
    serving.application()
    observation.keep(SCOPE, 200, 7, 0.5)
    written = capsys.readouterr().out
    assert written.count("\n") == (1 if wanted else 0)
    assert ('"bytes": 7, "ms": 500.0' in written) is bool(wanted)


@pytest.mark.parametrize("loaded", [True, False])
def test_a_worker_loads_at_once_what_it_was_told_to_and_reads_times_where_they_are(
    loaded: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    read: list[Knowledge] = []

    def load_all(known: Knowledge) -> None:
        read.append(known)

    monkeypatch.setattr(Knowledge, "load_all", load_all)
    monkeypatch.setenv(serving.WORKING, str(tmp_path))
    app = serving.application(loaded=loaded)
    assert read == [app.state.knowledge] * loaded
    assert app.state.knowledge.working == tmp_path


def test_a_service_that_is_not_installed_says_so_as_its_version(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def version(_name: str) -> str:
        raise PackageNotFoundError

    monkeypatch.setattr(service, "version", version)
    assert create_app(Knowledge()).version == "0+uninstalled"


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


def test_a_second_calibration_at_once_is_told_when_to_come_back(
    client_of: Callable[[FastAPI], Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(calibrations, "_BUSY", asyncio.Semaphore(0))
    files = {"file": ("b.csv", b"x_px,y_px,alpha,beta\n")}
    answer = client_of(create_app(Knowledge())).post("/v1/calibrations", files=files)
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "30")
    assert answer.json()["type"].endswith(":busy")


def test_a_body_without_an_end_is_read_no_further_than_the_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(requests, "LARGEST_BODY", 10)
    monkeypatch.setattr(requests, "LARGEST_READ", 40)
    sent = 0

    async def receive() -> Message:
        nonlocal sent
        sent += 15
        return {"type": "http.request", "body": bytes(15), "more_body": True}

    scope = {**SCOPE, "headers": [(b"content-type", b"application/json")]}
    with pytest.raises(Problem) as refused:
        asyncio.run(StrictRequest(scope, receive).body())
    assert (refused.value.status_code, sent) == (413, 45)
    assert "at most 10 bytes" in refused.value.detail


def passed_on(*messages: Message, kind: str = "http") -> list[Message]:
    """Return what is sent where an application sends these messages."""
    sent: list[Message] = []

    async def app(_scope: Scope, _receive: Receive, send: Send) -> None:
        for message in messages:
            await send(dict(message))

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "http.disconnect"}

    asyncio.run(EveryResponse(app)({**SCOPE, "type": kind}, receive, send))
    return sent


def test_only_responses_are_changed_on_their_way_out() -> None:
    start = {"type": "http.response.start", "status": 200, "headers": []}
    more = {"type": "http.response.trailers", "headers": [(b"a", b"b")], "more_trailers": False}
    body = {"type": "http.response.body", "body": b"1"}
    first, *others = passed_on(start, body, more)
    assert dict(first["headers"])[b"x-content-type-options"] == b"nosniff"
    assert others == [body, more]
    started = {"type": "lifespan.startup.complete"}
    assert passed_on(started, kind="lifespan") == [started]


def test_a_file_has_a_link_header_only_where_it_has_links() -> None:
    alone = Columns(b"PAR1", "a.parquet").representation(PARQUET)
    linked = Columns(b"PAR1", "a.parquet", ["</a>; rel=up", "</b>; rel=item"])
    assert "Link" not in alone._common
    assert linked.representation(PARQUET)._common["Link"] == "</a>; rel=up, </b>; rel=item"
    assert linked.headers["link"] == "</a>; rel=up, </b>; rel=item"


def test_an_example_of_a_header_is_no_part_of_the_address() -> None:
    parameters = [
        {"in": "header", "name": "Accept", "example": "text/csv"},
        {"in": "path", "name": "key", "example": "a b"},
        {"in": "query", "name": "mask", "example": ["slit", "dial"]},
        {"in": "query", "name": "limit"},
    ]
    assert target("/v1/{key}", {"parameters": parameters}) == (
        "/v1/a%20b?mask=slit&mask=dial",
        None,
    )


def test_links_are_added_to_bytes_whose_digest_is_known_already() -> None:
    made = Representation(b"a", "text/plain", digest="given")
    assert made.link() is made
    linked = made.link("</b>; rel=next").link("</c>; rel=up")
    assert linked.digest == "given"
    assert linked._common["Link"] == "</b>; rel=next, </c>; rel=up"


def test_what_is_kept_anew_under_a_key_counts_once() -> None:
    cache = RepresentationCache(most_bytes=100)
    for size in (60, 90):
        cache.put("a", Representation(bytes(size), "text/plain"))
    assert (len(cache), cache.bytes) == (1, 90)


class OfNothing(BaseModel):
    """A question for one of no words."""

    word: Annotated[str, OneOf(tuple)] = ""


class FreeText(BaseModel):
    """A question in words of one's own."""

    model_config = ConfigDict(json_schema_extra={"examples": [{"words": "sun"}]})
    words: str = ""


def test_of_an_empty_list_of_words_a_refusal_says_that_nothing_is_valid() -> None:
    async def endpoint(query: OfNothing) -> None: ...

    wrong = {"type": "value_error", "loc": ("query", "word"), "input": "x"}
    (violation,) = refusal([wrong], endpoint).errors
    assert violation.expected == "nothing: there is no valid value"


def test_an_operation_that_takes_any_text_has_no_example_of_a_refused_value() -> None:
    app = FastAPI()
    app.router.route_class = AnswerRoute

    @app.get("/free", response_class=Answer, response_model=FreeText)
    async def free(known: Known, query: Annotated[FreeText, Query()]) -> Answer:
        assert known is app.state.knowledge
        return Answer({"words": query.words}, ("words",), lambda: [{"words": query.words}])

    app.state.knowledge = Knowledge()
    routes = [route for route in app.routes if isinstance(route, AnswerRoute)]
    (operation,) = inlined(describe(app, routes))["/free"].values()
    said = operation["responses"]
    assert said["200"]["content"]["application/json"]["example"] == {"words": "sun"}
    assert "example" not in said["422"]["content"]["application/problem+json"]
    assert "example" in said["400"]["content"]["application/problem+json"]


def test_the_knowledge_of_all_editions_shares_what_is_measured() -> None:
    known = Knowledge()
    shared = {name: object() for name in ("evidence", "measured_pipelines", "index")}
    vars(known).update(shared)
    whole = known.of("all")
    assert whole.of("all") is whole
    assert whole.of("survey") is known
    assert {name: getattr(whole, name) for name in shared} == shared


@pytest.mark.parametrize("asked", [{"year_min": 0}, {"year_max": 9999}])
def test_a_study_without_a_year_is_in_no_range_of_years(
    asked: dict[str, int], knowledge: Knowledge
) -> None:
    key, study = next(iter(knowledge.facts.studies.items()))
    undated = {key: dataclasses.replace(study, year=None)}
    known = Knowledge(knowledge.measurements)
    vars(known).update(facts=dataclasses.replace(knowledge.facts, studies=undated))
    assert ask(studies, known, query={"key": [key], **asked}).document["items"] == []


def test_metadata_of_a_data_set_without_published_samples_describe_its_table_alone(
    knowledge: Knowledge, client_of: Callable[[FastAPI], Client], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("benchmark.results.samples.has_samples", lambda *_: False)
    client = client_of(create_app(knowledge))
    document = client.get("/v1/datasets/cmos-single-aperture/croissant.json").json()
    assert len(document["distribution"]) == 1
    assert len(document["recordSet"]) == 1
