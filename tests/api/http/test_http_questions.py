"""What is asked: queries and bodies as they are understood or refused, and pages of lists."""

import asyncio
import json
import re
from typing import Annotated, Any
from urllib.parse import urlencode

import pytest
from fastapi import APIRouter, Body, FastAPI, Query
from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import Field

from api.schema.base import Question
from api.schema.parameters import DEFAULT_PAGE, GIVEN, NUMBER, Cursor, Flag, Limit, OneOf, Several
from api.server import handlers
from api.service.asking import ask
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.pagination import page
from api.service.problems import Problem
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

fuzz = settings(deadline=None, derandomize=True)

Task = Annotated[str, OneOf(lambda: ("Accuracy", "Cost", "FOV"))]


class Asked(Question):
    """Parameters of every kind."""

    task: Several[Task] = Field(default_factory=list)
    max_error_deg: Annotated[float | None, NUMBER] = Field(None, gt=0, le=180)
    grouped: Flag = False
    q: Annotated[str | None, GIVEN] = Field(None, min_length=1, max_length=50)
    limit: Limit = DEFAULT_PAGE
    cursor: Cursor = None


class AskedInBody(Asked, strict=True):
    """The same in a body."""


def understood(known: Knowledge, query: Asked) -> Document:
    return Document(query.model_dump())


async def by_query(known: Known, query: Annotated[Asked, Query()]) -> Answer:
    return Answer(Document(query.model_dump()))


async def by_body(body: Annotated[AskedInBody, Body()]) -> Answer:
    return Answer(Document(body.model_dump()))


def service() -> FastAPI:
    """An application of two path functions that answer with what they understood."""
    router = APIRouter(route_class=AnswerRoute, default_response_class=Answer)
    router.get("/")(by_query)
    router.post("/")(by_body)
    app = FastAPI()
    app.state.knowledge = KNOWLEDGE
    app.include_router(router)
    handlers.install(app, router.routes)
    return app


KNOWLEDGE = Knowledge()
SERVICE = service()


def request(method: str, query: bytes = b"", body: bytes = b"") -> tuple[int, dict[str, Any]]:
    """Status and document of the answer to a request, whatever bytes its query is made of."""
    sent: list[dict[str, Any]] = []

    async def receive():
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message):
        sent.append(message)

    scope = {
        "type": "http",
        "method": method,
        "path": "/",
        "query_string": query,
        "headers": [(b"content-type", b"application/json"), (b"host", b"atlas.test")],
    }
    asyncio.run(SERVICE(scope, receive, send))
    return sent[0]["status"], json.loads(sent[1]["body"])


def read(query: str | bytes) -> dict[str, Any]:
    status, document = request("GET", query if isinstance(query, bytes) else query.encode())
    assert status == 200, document
    return document


def refusal(query: str | bytes) -> dict[str, Any]:
    status, document = request("GET", query if isinstance(query, bytes) else query.encode())
    assert status == document["status"] >= 400
    return document


def in_body(body: object) -> tuple[int, dict[str, Any]]:
    return request("POST", body=json.dumps(body).encode())


@pytest.mark.parametrize(
    "query",
    [f"max_error_deg={bad}" for bad in ("nan", "NaN", "inf", "-inf", "1e400", "-1", "0", "", "1_0")]
    + [f"max_error_deg={bad}" for bad in ("%D9%A1", "0x1", "1,5", "181", "Infinity", "%2B1")]
    + [f"limit={bad}" for bad in ("0", "501", "-1", "1.5", "x", "9" * 30)]
    + ["grouped=yes", "q=", "q=" + "x" * 51, "max_error_deg=1&max_error_deg=2", "cursor="],
)
def test_a_value_that_is_not_valid_is_a_422(query):
    problem = refusal(query)
    assert problem["status"] == 422
    assert problem["errors"][0]["parameter"] == query.partition("=")[0]


def test_a_parameter_has_a_hundred_values_at_most():
    assert read("&".join(["task=FOV"] * 100))["task"] == ["FOV"]
    many = refusal("&".join(["task=FOV"] * 101))
    assert many["status"] == 422
    assert many["errors"][0]["value"] == "101 values"
    assert in_body({"task": ["FOV"] * 100})[0] == 200
    assert in_body({"task": ["FOV"] * 101})[0] == 422


@pytest.mark.parametrize(
    ("query", "body", "expected"),
    [
        ("task=x", {"task": ["x"]}, "Accuracy, Cost, FOV"),
        ("max_error_deg=0", {"max_error_deg": 0}, r"number.*\b0\b.*\b180\b"),
        ("grouped=1", {"grouped": 1}, r"\btrue\b.*\bfalse\b"),
        ("q=", {"q": ""}, r"text.*\b1\b.*\b50\b"),
        ("limit=0", {"limit": 0}, r"integer.*\b1\b.*\b500\b"),
    ],
)
def test_query_and_body_are_refused_in_the_same_words(query, body, expected):
    status, document = in_body(body)
    assert status == 422
    (said,) = (error["expected"] for error in document["errors"])
    assert re.search(expected, said)
    assert [error["expected"] for error in refusal(query)["errors"]] == [said]


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ({"task": 5}, r"\blist\b.*Accuracy, Cost, FOV"),
        ({"max_error_deg": True}, r"number.*\b0\b.*\b180\b"),
        ({"max_error_deg": None}, r"number.*\b0\b.*\b180\b"),
        ({"limit": 1.5}, r"integer.*\b1\b.*\b500\b"),
        ([], "a JSON object"),
    ],
)
def test_a_body_is_taken_to_the_letter(body, expected):
    status, document = in_body(body)
    assert status == 422
    (said,) = (error["expected"] for error in document["errors"])
    assert re.search(expected, said)


def test_what_is_asked_in_this_process_is_refused_as_over_http():
    with pytest.raises(Problem) as refused:
        ask(understood, KNOWLEDGE, query={"task": ["fov"], "limit": 0})
    over_http = refusal("task=fov&limit=0")
    assert refused.value.document("/") == over_http
    with pytest.raises(Problem) as refused:
        ask(understood, KNOWLEDGE, query={"taks": ["FOV"]})
    assert refused.value.document("/") == refusal("taks=FOV")


@pytest.mark.parametrize("query", ["task", "&&", "task=%ff", "task=FOV&" * 600, "=", "\xff=1"])
def test_a_query_that_cannot_be_read_is_a_400(query):
    assert refusal(query.encode("latin-1"))["status"] == 400


@fuzz
@given(st.binary(max_size=40))
def test_any_query_is_read_or_refused(query):
    status, document = request("GET", query)
    assert status in (400, 422) or set(document) == set(Asked.model_fields)


@fuzz
@given(
    st.recursive(
        st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
        lambda inner: (
            st.lists(inner, max_size=3)
            | st.dictionaries(st.sampled_from(["task", "limit", "q", "x"]), inner, max_size=3)
        ),
    )
)
def test_any_body_is_read_or_refused(body):
    status, document = in_body(body)
    assert status in (400, 422) or set(document) == set(Asked.model_fields)


@fuzz
@given(
    st.lists(st.sampled_from(["Accuracy", "Cost", "FOV"]), max_size=4),
    st.none() | st.floats(0, 180, exclude_min=True),
    st.booleans(),
    st.integers(1, 500),
)
def test_query_and_body_mean_the_same(task, error, grouped, limit):
    body = {"task": task, "grouped": grouped, "limit": limit}
    if error is not None:
        body["max_error_deg"] = error
    status, understood = in_body(body)
    assert status == 200
    fields = {**body, "grouped": str(grouped).lower()}
    assert read(urlencode(fields, doseq=True)) == understood
    assert understood["task"] == sorted(set(task))


@pytest.mark.parametrize("digits", [400, 4000, 5000])
def test_integers_beyond_floats_are_refused(digits):
    for name in ("max_error_deg", "limit"):
        status, document = request("POST", body=b'{"%s": 1%s}' % (name.encode(), b"0" * digits))
        assert status in (400, 422)
        assert len(json.dumps(document)) < 1500


@fuzz
@given(st.integers(0, 40), st.integers(1, 15))
def test_pages_walk_the_whole_list_once(n, limit):
    rows = list(range(n))
    seen, cursor = [], None
    for _ in range(n + 1):
        given_out = {} if cursor is None else {"cursor": cursor}
        query = Asked.model_validate({"task": ["FOV"], "limit": limit, **given_out})
        found = page(rows, "/v1/x", query)
        assert found.total == n
        assert (found.next is None) == (found.link is None)
        seen += found.items
        cursor = found.next
        assert (cursor is None) == (len(seen) == n)
        if cursor is None:
            break
    assert seen == rows


def test_a_cursor_belongs_to_its_list():
    rows = list(range(10))

    def asked(task="FOV", **more):
        return Asked.model_validate({"task": [task], "limit": 3, **more})

    first = page(rows, "/v1/x", asked())
    cursor = first.next
    assert first.link == f'</v1/x?task=FOV&limit=3&cursor={cursor}>; rel="next"'
    for path, query in [("/v1/y", asked(cursor=cursor)), ("/v1/x", asked("Cost", cursor=cursor))]:
        with pytest.raises(Problem):
            page(rows, path, query)
    for wrong in ("x", "W10", cursor + "=", cursor[:-1], "é", "[" * 150):
        with pytest.raises(Problem) as refused:
            page(rows, "/v1/x", asked(cursor=wrong))
        assert refused.value.status_code == 400
    assert list(page(rows, "/v1/x", asked(cursor=cursor)).items) == [3, 4, 5]


@pytest.mark.parametrize(("number", "status"), [(1, 400), (2, 200), (4, 200), (5, 422)])
def test_two_to_four_architectures_are_compared(atlas: Any, number: int, status: int) -> None:
    every = ["CMOS:Single-Ap.", "CCD:Single-Ap.", "QPD:Single-Ap.", "PSD:Single-Ap.", "CCD:Slit"]
    asked = urlencode([("architecture", one) for one in every[:number]])
    answer = atlas.get(f"/v1/compare?{asked}")
    assert answer.status_code == status
    assert len(answer.json().get("items", ())) == (number if status == 200 else 0)
