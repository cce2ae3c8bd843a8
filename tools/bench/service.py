"""How fast a recommendation is over HTTP, as a ratio to an empty FastAPI endpoint.

`python -m tools.bench.service [--format json] [--seed N]`. Both applications run side by side under
uvicorn in this process, on one event loop; one client asks them in turn over kept connections, so
that whatever else the machine does hits both alike. Measured is processor time of this process,
which is that of server and client. Four kinds of queries: the same again and again
(answered from memory), and three that are different each time (computed): values excluded from
everything, a large answer; a task with a limit; and requirements drawn at random, of limits on
error and field, exclusions, tasks and orders. Exit status 1 where a ratio is above `LARGEST_RATIO`.
"""

from __future__ import annotations

import argparse
import asyncio
import gc
import json
import random
import socket
import statistics
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from http.client import HTTPConnection
from itertools import count, product
from typing import Any
from urllib.parse import urlencode

import uvicorn
from fastapi import FastAPI

from api.server.app import create_app
from api.server.connections import bounds
from registry.ranking import SORTS
from registry.studies import facts
from tools.bench.verdicts import Verdict, any_broken

LARGEST_RATIO = 3.0
PATH = "/v1/recommendations"
#: Questions of each kind before those that are measured.
WARM = 10
#: How often a drawn question has a requirement of a kind.
_SHARE = 0.4
#: A connection is kept however long the machine lets its next request wait, s.
_KEPT_S = 600


@dataclass(frozen=True)
class QueryTimes:
    """Processor times of one kind of queries.

    Attributes
    ----------
    queries : "repeated", or different each time: "excluding", "limiting" or "drawn"
    empty_us : median of the empty endpoint, in microseconds
    recommendation_us : median of the recommendation, in microseconds
    ratio : median over all rounds of the ratio of the round's medians
    mean_ratio : all recommendations together over all empty answers
    dear_ratio : the recommendation that 95 of 100 are below, over the median empty answer
    """

    queries: str
    empty_us: float
    recommendation_us: float
    ratio: float
    mean_ratio: float
    dear_ratio: float


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


def exclusion_paths() -> Iterator[str]:
    """Yield paths that ask for almost everything, each excluding another set of values."""
    values = facts().taxonomy.values
    names = ("extractor", "model", "detector", "error")
    for excluded in product(*(values(name) for name in names)):
        pairs = [(f"exclude_{name}", value) for name, value in zip(names, excluded, strict=True)]
        yield f"{PATH}?{urlencode(pairs)}"


def limit_paths() -> Iterator[str]:
    """Yield paths that ask for a task and an error never asked for before."""
    tasks = facts().taxonomy.values("task")
    for number in count():
        pairs = [("task", tasks[number % len(tasks)]), ("max_error_deg", 0.5 + number * 1e-6)]
        yield f"{PATH}?{urlencode(pairs)}"


def random_paths(seed: int) -> Iterator[str]:
    """Yield paths that ask for requirements drawn at random, none of them twice.

    Something meets them or nothing.
    """
    values = facts().taxonomy.values
    rng = random.Random(seed)
    before: set[str] = set()
    while True:
        asked: dict[str, object] = {"sort": rng.choice(SORTS)}
        if rng.random() < _SHARE:
            asked["max_error_deg"] = 10.0 ** rng.uniform(-2.0, 1.0)
        if rng.random() < _SHARE:
            asked["min_fov_deg"] = rng.uniform(5.0, 160.0)
        if rng.random() < _SHARE:
            asked["task"] = rng.choice(values("task"))
        for name in ("detector", "mask", "model", "extractor", "error"):
            if rng.random() < _SHARE:
                asked[f"exclude_{name}"] = rng.choice(values(name))
        path = f"{PATH}?{urlencode(asked)}"
        if path not in before:
            before.add(path)
            yield path


def repeated_path() -> Iterator[str]:
    """Yield the same path again and again."""
    while True:
        yield f"{PATH}?task=Accuracy"


def time_answer(connection: HTTPConnection, path: str) -> float:
    """Return the processor time of an answer, in microseconds.

    Raises
    ------
    RuntimeError
        Where it is a refusal.
    """
    start = time.process_time_ns()
    connection.request("GET", path)
    response = connection.getresponse()
    response.read()
    spent = (time.process_time_ns() - start) / 1e3
    if response.status != 200:
        raise RuntimeError(f"{path} was answered by {response.status}")
    return spent


def measure(
    seed: int, rounds: int = 15, requests: int = 30, app: FastAPI | None = None
) -> list[QueryTimes]:
    """Measure every kind of queries, `rounds` times `requests` interleaved pairs each.

    Parameters
    ----------
    seed : of what is drawn
    rounds, requests : how many
    app : the service, not asked before: what it remembers would not be computed
    """
    service = create_app() if app is None else app
    kinds = {
        "repeated": repeated_path(),
        "excluding": exclusion_paths(),
        "limiting": limit_paths(),
        "drawn": random_paths(seed),
    }
    found: dict[str, list[list[tuple[float, float]]]] = {name: [] for name in kinds}
    with serve([empty_app(), service]) as (empty, atlas):
        for paths in kinds.values():  # warm
            for _ in range(WARM):
                time_answer(empty, "/")
                time_answer(atlas, next(paths))
        for _ in range(rounds):
            for name, paths in kinds.items():
                gc.collect()
                found[name].append(
                    [
                        (time_answer(empty, "/"), time_answer(atlas, next(paths)))
                        for _ in range(requests)
                    ]
                )
    return [summary(name, pairs) for name, pairs in found.items()]


def summary(queries: str, rounds: Sequence[Sequence[tuple[float, float]]]) -> QueryTimes:
    """Sum up the times (empty, recommendation) of every round."""
    empty, answers = zip(*(pair for pairs in rounds for pair in pairs), strict=True)
    ratios = [
        statistics.median(a) / statistics.median(e)
        for e, a in (zip(*r, strict=True) for r in rounds)
    ]
    typical = statistics.median(empty)
    return QueryTimes(
        queries,
        typical,
        statistics.median(answers),
        statistics.median(ratios),
        sum(answers) / sum(empty),
        sorted(answers)[int(0.95 * len(answers))] / typical,
    )


def verdicts(results: Sequence[QueryTimes]) -> list[Verdict]:
    """Return the verdict on each kind of queries."""
    return [
        Verdict(
            f"{result.queries}: processor time over an empty endpoint's",
            result.ratio,
            LARGEST_RATIO,
        )
        for result in results
    ]


def run(seed: int) -> list[Verdict]:
    """Measure and print; return the verdicts."""
    results = measure(seed)
    _print(results)
    return verdicts(results)


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.bench.service", description=__doc__)
    parser.add_argument("--format", choices=("text", "json"), default="text")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--requests", type=int, default=30)
    parser.add_argument("--seed", type=int, default=36, help="of what is drawn")
    given = parser.parse_args(arguments)
    results = measure(given.seed, given.rounds, given.requests)
    lost = any_broken(verdicts(results))
    if given.format == "json":
        document = {
            "largest_ratio": LARGEST_RATIO,
            "kept": not lost,
            "measured": [asdict(result) for result in results],
        }
        print(json.dumps(document, indent=2))
    else:
        _print(results)
    return 1 if lost else 0


def _print(results: Sequence[QueryTimes]) -> None:
    for result in results:
        print(
            f"{result.queries:10s} {result.recommendation_us:8.0f} us, "
            f"empty endpoint {result.empty_us:6.0f} us, ratio {result.ratio:.2f} "
            f"(at most {LARGEST_RATIO:g}; mean {result.mean_ratio:.2f}, 95 of 100 below "
            f"{result.dear_ratio:.2f})"
        )


if __name__ == "__main__":
    sys.exit(main())
