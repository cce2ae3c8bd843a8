"""Count the calls and the steps between files that one new recommendation takes on a warm service.

``python -m tools.trace_request [query ...]``. The service runs in this process, without a server.
It is warmed by questions drawn at random; then every call of this project's own functions is
counted for each new question. A step is a call of a function of another file than the call before.
"""

from __future__ import annotations

import argparse
import asyncio
import statistics
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from types import FrameType

from starlette.types import ASGIApp, Message

from api.server.app import create_app
from tools.bench.service import random_paths

ROOT = Path(__file__).parents[1]
WARM, TRACED, SEED = 100, 20, 36


@dataclass
class Trace:
    """Calls of this project's functions, in which files, and steps from file to file."""

    calls: int = 0
    steps: int = 0
    files: set[str] = field(default_factory=set)
    last: str = ""

    def __call__(self, frame: FrameType, event: str, _argument: object) -> None:
        """Count a call, as `sys.setprofile` hands it in."""
        name = frame.f_code.co_filename
        if event != "call" or not name.startswith(str(ROOT)):
            return
        self.calls += 1
        self.steps += name != self.last
        self.files.add(name)
        self.last = name


async def ask(app: ASGIApp, path: str) -> None:
    """Ask the service for a path with a query; RuntimeError where it is refused."""
    path, _, query = path.partition("?")
    scope = {
        "type": "http",
        "method": "GET",
        "http_version": "1.1",
        "scheme": "http",
        "path": path,
        "raw_path": path.encode(),
        "query_string": query.encode(),
        "root_path": "",
        "headers": [],
        "server": ("localhost", 80),
        "client": ("localhost", 1),
    }
    statuses: list[int] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        statuses.append(message.get("status", 200))

    await app(scope, receive, send)
    if statuses[0] != 200:
        raise RuntimeError(f"{path}?{query} was answered by {statuses[0]}")


async def trace(app: ASGIApp, path: str) -> Trace:
    """Return the trace of one question."""
    trace = Trace()
    sys.setprofile(trace)
    try:
        await ask(app, path)
    finally:
        sys.setprofile(None)
    return trace


async def run(paths: Iterator[str]) -> list[tuple[str, Trace]]:
    """Warm the service, then trace questions that it was not asked before."""
    app = create_app()
    for path in islice(random_paths(SEED), WARM):
        await ask(app, path)
    return [(path, await trace(app, path)) for path in paths]


def main(arguments: Sequence[str] | None = None) -> int:
    """Trace, print, and return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tools.trace_request", description=__doc__)
    parser.add_argument("query", nargs="*", help="such as task=Accuracy&max_error_deg=0.5")
    queries: list[str] = parser.parse_args(arguments).query
    asked = [f"/v1/recommendations?{query}" for query in queries]
    found = asyncio.run(
        run(iter(asked) if asked else islice(random_paths(SEED), WARM, WARM + TRACED))
    )
    for path, trace in found:
        print(f"{trace.calls:6d} calls {len(trace.files):3d} files {trace.steps:5d} steps  {path}")
    for name in ("calls", "steps"):
        print(f"median {name}: {statistics.median(getattr(trace, name) for _, trace in found):g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
