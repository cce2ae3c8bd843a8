"""A client that asks the application in this process, as a browser would ask a server."""

from __future__ import annotations

import asyncio
import csv
import io
import os
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from http.client import HTTPConnection
from typing import Any

import httpx
import pytest
import uvicorn
from fastapi import FastAPI

from api.cli import asking
from api.server import app as service
from api.server.app import create_app
from api.service.knowledge import Knowledge


class Client:
    """Synchronous requests to an ASGI application, on one event loop."""

    def __init__(self, app: FastAPI) -> None:
        self.app = app
        self._runner = asyncio.Runner()
        transport = httpx.ASGITransport(app, raise_app_exceptions=False)
        self._client = httpx.AsyncClient(transport=transport, base_url="http://atlas.test")

    def request(self, method: str, url: str, **options: Any) -> httpx.Response:
        return self._runner.run(self._client.request(method, url, **options))

    def get(self, url: str, accept: str | None = None, **options: Any) -> httpx.Response:
        headers = {**options.pop("headers", {}), **({"Accept": accept} if accept else {})}
        return self.request("GET", url, headers=headers, **options)

    def post(self, url: str, **options: Any) -> httpx.Response:
        return self.request("POST", url, **options)

    def table(self, url: str) -> list[dict[str, str]]:
        """Rows of the CSV at `url`."""
        response = self.get(url, accept="text/csv")
        assert response.status_code == 200, response.text
        assert response.headers["content-type"].startswith("text/csv")
        return list(csv.DictReader(io.StringIO(response.text, newline="")))

    def walk(self, url: str) -> list[dict[str, Any]]:
        """All items of a list, page by page along the Link header."""
        items: list[dict[str, Any]] = []
        following: str | None = url
        while following is not None:
            response = self.get(following)
            assert response.status_code == 200, response.text
            page = response.json()
            items += page["items"]
            link = response.links.get("next")
            assert (link is None) == (page["next"] is None)
            following = None if link is None else link["url"]
        return items

    def close(self) -> None:
        self._runner.run(self._client.aclose())
        self._runner.close()


@pytest.fixture(scope="session", autouse=True)
def _own_working_store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Neither read nor touch what this user measured and timed; workers share a built guide."""
    working, base = tmp_path_factory.mktemp("working"), tmp_path_factory.getbasetemp()
    shared = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "guide"
    shared.mkdir(exist_ok=True)
    (working / "guide").symlink_to(shared)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SUNATLAS_STORE", str(working))
        yield


@pytest.fixture(scope="session", autouse=True)
def knowledge(_own_working_store: None) -> Iterator[Knowledge]:
    """What is published, read once for the service, the command line and the docs: 5 s each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(service, "Knowledge", asking.knowledge)
        yield asking.knowledge()


@pytest.fixture(scope="session")
def atlas(knowledge: Knowledge) -> Iterator[Client]:
    """The service as it is served."""
    client = Client(create_app(knowledge))
    yield client
    client.close()


@pytest.fixture(scope="session")
def client_of() -> Iterator[Callable[[FastAPI], Client]]:
    """Makes clients of other applications."""
    made: list[Client] = []

    def make(app: FastAPI) -> Client:
        made.append(Client(app))
        return made[-1]

    yield make
    for client in made:
        client.close()


@contextmanager
def _serving(app: FastAPI, **options: Any) -> Iterator[HTTPConnection]:
    """Serve from a thread of this process, with options of `uvicorn.Config`."""
    # The protocol is named: asyncio turns Nagle's algorithm off only where it is.
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.bind(("127.0.0.1", 0))
    listening.listen()
    listening.setblocking(False)
    # a connection is kept however long the machine lets its next request wait
    chosen = {"timeout_keep_alive": 600, "lifespan": "off", **options}
    server = uvicorn.Server(uvicorn.Config(app, log_level="error", access_log=False, **chosen))
    thread = threading.Thread(target=server.run, args=([listening],), daemon=True)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive(), "the server did not start; its log says why"
            time.sleep(0.01)
        connection = HTTPConnection(*listening.getsockname())
        yield connection
        connection.close()
    finally:
        server.should_exit = True
        thread.join()
        listening.close()


@pytest.fixture(scope="session")
def serve() -> Callable[..., AbstractContextManager[HTTPConnection]]:
    """Serves an application on a free port; gives a connection to it."""
    return _serving
