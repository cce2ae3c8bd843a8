"""What the service says of its own work to Prometheus: counts and times of requests.

Labels are templates of routes, never paths as they are asked for: what anybody can make up is no
label. With several workers their numbers are added up through files in the directory that
`PROMETHEUS_MULTIPROC_DIR` names, which has to be set before a worker imports this module.
"""

from __future__ import annotations

import os

from prometheus_client import REGISTRY, CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector
from starlette.types import Scope

METHODS = frozenset({"GET", "HEAD", "POST", "OPTIONS", "PUT", "PATCH", "DELETE"})
UNMATCHED = "unmatched"
BUCKETS_S = (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0)
REQUESTS = Counter("sunatlas_http_requests", "Requests answered.", ("method", "route", "status"))
SECONDS = Histogram(
    "sunatlas_http_seconds", "Time to answer.", ("method", "route"), buckets=BUCKETS_S
)


def exposition() -> bytes:
    """Return the numbers of all workers as Prometheus reads them."""
    if "PROMETHEUS_MULTIPROC_DIR" not in os.environ:
        return generate_latest(REGISTRY)
    registry = CollectorRegistry()
    MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
    return generate_latest(registry)


def count(scope: Scope, status: int, seconds: float) -> None:
    """Count and time a request that has been answered; `scope` is as the router left it."""
    route = getattr(scope.get("route"), "path", UNMATCHED)
    method = scope["method"] if scope["method"] in METHODS else "other"
    REQUESTS.labels(method, route, str(status)).inc()
    SECONDS.labels(method, route).observe(seconds)
