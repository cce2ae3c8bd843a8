"""What is asked under load: kinds of requests in fixed shares, drawn by seed."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import quote, urlencode


@dataclass(frozen=True)
class Request:
    """One request, and what may be answered to it."""

    kind: str
    path: str
    method: str = "GET"
    headers: Mapping[str, str] = field(default_factory=dict)
    body: bytes | None = None


@dataclass(frozen=True)
class Names:
    """What a service knows, by its own lists."""

    studies: tuple[str, ...]
    datasets: tuple[str, ...]
    claims: tuple[str, ...]
    detectors: tuple[str, ...]
    masks: tuple[str, ...]
    assets: tuple[str, ...]


Make = Callable[[random.Random, Names], tuple[str, dict[str, Any] | None]]

_CHARTS = ("error", "performance", "task", "cross-analysis", "model-sunburst")
_PAGES = ("/v1/studies", "/v1/algorithms", "/v1/results", "/v1/sweeps", "/v1/curves")
_FIXED = (
    *("/v1/taxonomy", "/v1/leaderboard", "/v1/leaderboard/architectures", "/v1/assessment"),
    *("/v1/leaderboard/overview", "/v1/realism", "/v1/claims", "/v1/datasets", "/healthz"),
)
_WRONG = (
    *("/v1/nothing", "/v1/studies/Nobody1900", "/v1/studies?limit=-1", "/v1/flows/none"),
    *("/v1/datasets/none", "/v1/recommendations?max_error=abc", "/v1/results?dataset=%ff"),
    *("/v1/studies?offset=99999999999999999999", "/v1/claims/C999", "/v1/leaderboard/%00"),
)


def _requirements(draw: random.Random, names: Names) -> dict[str, Any]:
    asked: dict[str, Any] = {"max_error_deg": round(10 ** draw.uniform(-3, 1), 4)}
    if draw.random() < 0.4:
        asked["detector"] = [draw.choice(names.detectors)]
    if draw.random() < 0.3:
        asked["mask"] = [draw.choice(names.masks)]
    if draw.random() < 0.4:
        asked["min_fov_deg"] = draw.choice([30, 60, 90, 120])
    return asked


#: Kind -> its share, and how one is made: the path, and a document to post or None.
KINDS: Mapping[str, tuple[int, Make]] = {
    "the page and its files": (10, lambda draw, names: (draw.choice(names.assets), None)),
    "fixed lists": (20, lambda draw, _: (draw.choice(_FIXED), None)),
    "pages of lists": (
        10,
        lambda draw, _: (f"{draw.choice(_PAGES)}?limit={draw.randint(1, 100)}", None),
    ),
    "studies of a detector": (
        5,
        lambda draw, names: (f"/v1/studies?limit=20&detector={draw.choice(names.detectors)}", None),
    ),
    "a study": (10, lambda draw, names: (f"/v1/studies/{quote(draw.choice(names.studies))}", None)),
    "a data set or its board": (
        10,
        lambda draw, names: (
            f"/v1/{draw.choice(('datasets', 'leaderboard'))}/{draw.choice(names.datasets)}",
            None,
        ),
    ),
    "a claim": (5, lambda draw, names: (f"/v1/claims/{draw.choice(names.claims)}", None)),
    "flows": (5, lambda draw, _: (f"/v1/flows/{draw.choice(_CHARTS)}", None)),
    "recommendations": (
        15,
        lambda draw, names: (
            f"/v1/recommendations?{urlencode(_requirements(draw, names), doseq=True)}",
            None,
        ),
    ),
    "recommendations, posted": (
        5,
        lambda draw, names: ("/v1/recommendations", _requirements(draw, names)),
    ),
    "wrong requests": (5, lambda draw, _: (draw.choice(_WRONG), None)),
}


def drawn(draw: random.Random, names: Names) -> Request:
    """Draw a request; a third of those that read ask for CSV, or compressed."""
    kinds = list(KINDS)
    kind = draw.choices(kinds, [KINDS[name][0] for name in kinds])[0]
    path, document = KINDS[kind][1](draw, names)
    if document is not None:
        headers = {"Content-Type": "application/json"}
        return Request(kind, path, "POST", headers, json.dumps(document).encode())
    headers = draw.choice([{}, {"Accept-Encoding": "gzip"}, {"Accept": "text/csv, */*;q=0.5"}])
    return Request(kind, path, headers=headers)
