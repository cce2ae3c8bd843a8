"""What the service says of its own work: counts and times for Prometheus, a line a request.

Labels are templates of routes, never paths as they are asked for: what anybody can make up is no
label. With several workers their numbers are added up through files in the directory that
`PROMETHEUS_MULTIPROC_DIR` names, which has to be set before this module is first used.
"""

from __future__ import annotations

import json
import logging
import os
import sys
from datetime import UTC, datetime
from functools import cache
from typing import TYPE_CHECKING, Any

from starlette.types import Scope

if TYPE_CHECKING:
    from prometheus_client import Counter, Histogram

METHODS = frozenset({"GET", "HEAD", "POST", "OPTIONS", "PUT", "PATCH", "DELETE"})
UNMATCHED = "unmatched"
BUCKETS_S = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0)
LONGEST_ECHO = 300  # characters of what a client sent, in a line of the log

LOG = logging.getLogger("sunatlas.access")


@cache
def _numbers() -> tuple[Counter, Histogram]:
    from prometheus_client import Counter, Histogram  # noqa: PLC0415 - reads the environment

    labels = ("method", "route", "status")
    return (
        Counter("sunatlas_http_requests", "Requests answered.", labels),
        Histogram("sunatlas_http_seconds", "Time to answer.", labels[:2], buckets=BUCKETS_S),
    )


def exposition() -> bytes:
    """Return the numbers of all workers as Prometheus reads them."""
    from prometheus_client import REGISTRY, CollectorRegistry, generate_latest  # noqa: PLC0415

    _numbers()
    if "PROMETHEUS_MULTIPROC_DIR" not in os.environ:
        return generate_latest(REGISTRY)
    from prometheus_client.multiprocess import MultiProcessCollector  # noqa: PLC0415

    registry = CollectorRegistry()
    MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
    return generate_latest(registry)


def log_requests() -> None:
    """Write a JSON line a request to standard output."""
    handler = logging.StreamHandler(sys.stdout)
    handler.setFormatter(logging.Formatter("%(message)s"))
    LOG.handlers = [handler]
    LOG.propagate = False
    LOG.setLevel(logging.INFO)


def keep(scope: Scope, status: int, length: int, seconds: float) -> None:
    """Count and time a request that has been answered, and write its line.

    Parameters
    ----------
    scope : of the request, as the router left it
    status, length : of the answer, bytes
    seconds : that it took
    """
    route = getattr(scope.get("route"), "path", UNMATCHED)
    method = scope["method"] if scope["method"] in METHODS else "other"
    requests, times = _numbers()
    _child(requests, method, route, str(status)).inc()
    _child(times, method, route).observe(seconds)
    if LOG.isEnabledFor(logging.INFO) and LOG.handlers:
        LOG.info(_line(scope, route, status, length, seconds))


@cache
def _child(metric: Any, *labels: str) -> Any:
    return metric.labels(*labels)


def _line(scope: Scope, route: str, status: int, length: int, seconds: float) -> str:
    headers = dict(scope["headers"])
    agent = headers.get(b"user-agent", b"").decode("latin-1")
    query = scope["query_string"].decode("latin-1")
    line = {
        "time": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "client": scope["client"][0] if scope.get("client") else None,
        "method": scope["method"],
        "path": scope["path"][:LONGEST_ECHO],
        "query": query[:LONGEST_ECHO],
        "route": route,
        "status": status,
        "bytes": length,
        "ms": round(seconds * 1e3, 3),
        "agent": agent[:LONGEST_ECHO],
    }
    # Only ASCII: what a client sends cannot break the line, nor the terminal that shows it.
    return json.dumps(line)
