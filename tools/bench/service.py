"""How fast and how large recommendations are: ``python -m tools.bench.service [--seed N]``.

The service runs under uvicorn in this process; one client asks it questions drawn at random, then
one question again and again. Printed are milliseconds, bytes of the usual answer and of the OpenAPI
document, and lines of the code that answers. The limits on times are for the development machine.
"""

from __future__ import annotations

import argparse
import asyncio
import random
import socket
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from http.client import HTTPConnection
from itertools import islice
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import uvicorn
from fastapi import FastAPI

from api.server.app import create_app
from api.server.connections import bounds
from registry.ranking import SORTS
from registry.requirements import HAZARDS, MISSIONS
from registry.studies import facts
from tools.bench.verdicts import Verdict, any_broken

PATH = "/v1/recommendations"
NEW_MS, REPEATED_MS = 20.0, 3.0
"""What 95 of 100 new questions, and of repeated ones, may take on the development machine."""
ANSWER_BYTES, OPENAPI_BYTES = 30_000, 200_000
LINES = 9_318
"""Lines of `registry` and `api/schema`: 1,500 fewer than they had when answers were bytes, with 480
that grade runs by evidence."""
#: Questions before those that are measured, and how often one has a requirement of a kind.
_WARM, _SHARE = 20, 0.35
#: A connection is kept however long the machine lets its next request wait, s.
_KEPT_S = 600


def empty_app() -> FastAPI:
    """Return the reference: an application whose endpoint does nothing."""
    app = FastAPI()

    @app.get("/")
    async def nothing() -> dict[str, str]:
        return {}

    return app


@contextmanager
def serve(apps: Sequence[FastAPI], **options: Any) -> Iterator[list[HTTPConnection]]:
    """Serve applications from a thread of this process; yield a connection to each.

    `options` are those of `uvicorn.Config`.
    """
    chosen = {**bounds(), "timeout_keep_alive": _KEPT_S, **options}
    servers = [
        uvicorn.Server(uvicorn.Config(app, log_level="error", access_log=False, **chosen))
        for app in apps
    ]
    sockets = [_listening() for _ in apps]

    async def serve_all() -> None:
        pairs = zip(servers, sockets, strict=True)
        await asyncio.gather(*(server.serve(sockets=[listening]) for server, listening in pairs))

    thread = threading.Thread(target=asyncio.run, args=(serve_all(),), daemon=True)
    thread.start()
    try:
        while not all(server.started for server in servers):
            if not thread.is_alive():
                raise RuntimeError("the servers did not start; their log says why")
            time.sleep(0.01)
        connections = [HTTPConnection(*listening.getsockname()) for listening in sockets]
        yield connections
        for connection in connections:
            connection.close()
    finally:
        for server in servers:
            server.should_exit = True
        thread.join()
        for listening in sockets:
            listening.close()


def _listening() -> socket.socket:
    """Return a socket that listens on a free port of the loopback interface.

    Its protocol is named: asyncio turns Nagle's algorithm off only where it is, and with it on an
    answer in two packets waits 40 ms for an acknowledgement, which would flatter every ratio.
    """
    listening = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    listening.bind(("127.0.0.1", 0))
    listening.listen()
    listening.setblocking(False)
    return listening


def random_paths(seed: int) -> Iterator[str]:
    """Yield paths that ask for requirements drawn at random, none of them twice.

    Something meets them or nothing.
    """
    values = facts().taxonomy.values
    rng = random.Random(seed)
    before: set[str] = set()
    numbers = {
        "max_error_deg": lambda: 10.0 ** rng.uniform(-3.5, 1.0),
        "min_fov_deg": lambda: rng.uniform(5.0, 200.0),
        "bench_deg": lambda: 10.0 ** rng.uniform(-3.0, -1.0),
        "max_mass_g": lambda: 10.0 ** rng.uniform(0.5, 3.0),
        "max_latency_us": lambda: 10.0 ** rng.uniform(0.0, 4.0),
    }
    while True:
        asked: dict[str, object] = {"sort": rng.choice(SORTS)}
        asked |= {name: draw() for name, draw in numbers.items() if rng.random() < _SHARE}
        for name in ("task", "accuracy", "detector"):
            if rng.random() < _SHARE / 2:
                asked[name] = rng.choice(values(name))
        for name in ("detector", "mask", "model", "extractor", "error"):
            if rng.random() < _SHARE:
                asked[f"exclude_{name}"] = rng.choice(values(name))
        for name, among in (("survive", HAZARDS), ("mission", MISSIONS)):
            if rng.random() < _SHARE / 3:
                asked[name] = rng.choice(list(among))
        path = f"{PATH}?{urlencode(asked)}"
        if path not in before:
            before.add(path)
            yield path


def ask(connection: HTTPConnection, path: str) -> tuple[float, int]:
    """Return how long an answer takes, in milliseconds, and its size in bytes.

    Raises
    ------
    RuntimeError
        Where it is a refusal.
    """
    start = time.perf_counter()
    connection.request("GET", path)
    response = connection.getresponse()
    size = len(response.read())
    spent = 1e3 * (time.perf_counter() - start)
    if response.status != 200:
        raise RuntimeError(f"{path} was answered by {response.status}")
    return spent, size


def measure(seed: int, questions: int = 300, app: FastAPI | None = None) -> list[Verdict]:
    """Ask drawn questions, then one again and again; return what was measured with its limit.

    Parameters
    ----------
    seed, questions : of the draw, and how many
    app : the service, not asked before
    """
    drawn = random_paths(seed)
    with serve([create_app() if app is None else app]) as (connection,):
        for path in islice(drawn, _WARM):
            ask(connection, path)
        new = [ask(connection, path)[0] for path in islice(drawn, questions)]
        repeated = [ask(connection, PATH)[0] for _ in range(questions + 1)][1:]
        sizes = {path: ask(connection, path)[1] for path in (PATH, "/openapi.json")}
    return [
        Verdict("a new question, ms (95 of 100)", _of_95(new), NEW_MS),
        Verdict("a repeated question, ms (95 of 100)", _of_95(repeated), REPEATED_MS),
        Verdict("the usual answer, bytes", sizes[PATH], ANSWER_BYTES),
        Verdict("the OpenAPI document, bytes", sizes["/openapi.json"], OPENAPI_BYTES),
        Verdict("lines of registry and api/schema", _lines(), LINES),
    ]


def _of_95(times: Sequence[float]) -> float:
    return sorted(times)[int(0.95 * len(times))]


def _lines() -> int:
    root = Path(__file__).parents[2]
    files = [*(root / "registry").rglob("*.py"), *(root / "api" / "schema").rglob("*.py")]
    return sum(len(file.read_text(encoding="utf-8").splitlines()) for file in files)


def run(seed: int) -> list[Verdict]:
    """Measure and print; return the verdicts."""
    found = measure(seed)
    for verdict in found:
        print(f"{verdict.what}: {verdict.value:.4g} (at most {verdict.most:g})")
    return found


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.service", description=__doc__)
    parser.add_argument("--seed", type=int, default=36, help="of what is drawn")
    return 1 if any_broken(run(parser.parse_args(arguments).seed)) else 0


if __name__ == "__main__":
    sys.exit(main())
