"""Equal questions are computed once a process; what may differ between them is asked anew."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from starlette.types import Message

from api.server import kept
from api.server.kept import KeptAnswers
from api.server.prefix import KEY

ROUTE = object()


class Asked:
    """An application that counts what it is asked, and a client of it."""

    def __init__(self, status: int = 200, size: int = 9, **headers: str) -> None:
        self.count, self.status, self.size = 0, status, size
        self.headers = [(k.replace("_", "-").encode(), v.encode()) for k, v in headers.items()]
        self.kept = KeptAnswers(self)

    async def __call__(self, scope: Any, _receive: Any, send: Any) -> None:
        self.count += 1
        scope["route"] = ROUTE
        headers = list(self.headers)
        await send({"type": "http.response.start", "status": self.status, "headers": headers})
        body = b"%d" % self.count * self.size
        await send({"type": "http.response.body", "body": body, "more_body": True})
        await send({"type": "http.response.body", "body": b"."})

    def ask(self, path: str = "/", **differing: Any) -> tuple[int, bytes, Any]:
        """Ask, and spoil the message that came, as who sends it on may."""
        scope = {"type": "http", "method": "GET", "scheme": "http", "path": path, "headers": []}
        scope |= {"query_string": b"", **differing}
        told: list[Message] = []

        async def send(message: Message) -> None:
            told.append(dict(message))
            if "headers" in message:
                assert message["headers"] == self.headers
                message["status"] = 304
                message["headers"].append((b"etag", b"1"))

        asyncio.run(self.kept(scope, None, send))  # type: ignore[arg-type]
        return told[0]["status"], b"".join(m.get("body", b"") for m in told), scope["route"]


def test_an_equal_question_is_answered_from_memory_as_the_first() -> None:
    asked = Asked(content_type="text/plain")
    assert asked.ask() == asked.ask() == (200, b"1" * 9 + b".", ROUTE)
    assert asked.count == 1


@pytest.mark.parametrize(
    "other",
    [
        {"path": "/a"},
        {"query_string": b"a=1"},
        {"headers": [(b"accept", b"text/csv")]},
        {"headers": [(b"accept-encoding", b"br, gzip")]},
        {"headers": [(b"host", b"a.example")]},
        {"scheme": "https"},
        {KEY: "/atlas"},
    ],
)
def test_what_an_answer_depends_on_makes_another_question(other: dict[str, Any]) -> None:
    asked = Asked()
    first = asked.ask()
    assert asked.ask(**other) != first
    assert (asked.ask(), asked.ask(**other)[1][:1]) == (first, b"2")


@pytest.mark.parametrize(
    ("asked", "differing"),
    [
        (Asked(cache_control="no-store"), {}),
        (Asked(404), {}),
        (Asked(), {"method": "POST"}),
        (Asked(), {"path": "/guide/index.html"}),
        (Asked(size=kept.LARGEST), {}),
    ],
)
def test_others_are_asked_anew(asked: Asked, differing: dict[str, Any]) -> None:
    assert asked.ask(**differing) != asked.ask(**differing)


def test_what_nobody_asked_for_longest_goes_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "MOST", 30)  # three answers
    asked = Asked()
    for path in "/a", "/b", "/c", "/a", "/d":
        asked.ask(path)
    assert asked.count == 4
    for path in "/a", "/c", "/d":
        asked.ask(path)
    assert asked.count == 4
    asked.ask("/b")
    assert asked.count == 5


def test_a_kept_answer_counts_under_its_route_and_is_revalidated(atlas: Any) -> None:
    first, second = atlas.get("/v1/claims/C04"), atlas.get("/v1/claims/C04")
    assert (first.content, first.headers) == (second.content, second.headers)
    again = {"If-None-Match": first.headers["etag"]}
    assert atlas.get("/v1/claims/C04", headers=again).status_code == 304
    line = 'sunatlas_http_requests_total{method="GET",route="/v1/claims/{id}",status="304"}'
    assert line in atlas.get("/metrics").text
