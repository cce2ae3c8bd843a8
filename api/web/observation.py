"""What the service says of its own work: counts and times for Prometheus, a line a request.

Labels are templates of routes, never paths as they are asked for: what anybody can make up is no
label. With several workers their numbers are added up through files in the directory that
`PROMETHEUS_MULTIPROC_DIR` names, which has to be set before a worker imports this module.
"""

from __future__ import annotations

import json
import logging
import os
import sys
from datetime import UTC, datetime

from prometheus_client import REGISTRY, CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector
from starlette.types import Scope

METHODS = frozenset({"GET", "HEAD", "POST", "OPTIONS", "PUT", "PATCH", "DELETE"})
UNMATCHED = "unmatched"
BUCKETS_S = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0)
LONGEST_ECHO = 300  # characters of what a client sent, in a line of the log
REQUESTS = Counter("sunatlas_http_requests", "Requests answered.", ("method", "route", "status"))
SECONDS = Histogram(
    "sunatlas_http_seconds", "Time to answer.", ("method", "route"), buckets=BUCKETS_S
)
LOG = logging.getLogger("sunatlas.access")


def exposition() -> bytes:
    """Return the numbers of all workers as Prometheus reads them."""
    if "PROMETHEUS_MULTIPROC_DIR" not in os.environ:
        return generate_latest(REGISTRY)
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
    REQUESTS.labels(method, route, str(status)).inc()
    SECONDS.labels(method, route).observe(seconds)
    if not LOG.handlers:
        return
    agent = dict(scope["headers"]).get(b"user-agent", b"")
    line = {
        "time": datetime.now(UTC).isoformat(timespec="milliseconds"),
        "client": scope["client"][0] if scope.get("client") else None,
        "method": scope["method"],
        "path": scope["path"][:LONGEST_ECHO],
        "query": scope["query_string"].decode("latin-1")[:LONGEST_ECHO],
        "route": route,
        "status": status,
        "bytes": length,
        "ms": round(seconds * 1e3, 3),
        "agent": agent.decode("latin-1")[:LONGEST_ECHO],
    }
    # Only ASCII: what a client sends cannot break the line, nor the terminal that shows it.
    LOG.info(json.dumps(line))
