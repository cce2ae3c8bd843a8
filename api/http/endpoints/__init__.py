"""The endpoints under /v1, one module a subject; each gives its endpoints from what is known."""

from __future__ import annotations

from api.http.endpoint import Endpoint
from api.http.endpoints import (
    assessment,
    flows,
    implementations,
    measured,
    recommendations,
    studies,
    taxonomy,
)
from api.http.knowledge import Knowledge

SUBJECTS = (taxonomy, studies, flows, recommendations, implementations, measured, assessment)


def all_endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return every endpoint under /v1, in the order of the documentation."""
    return [endpoint for subject in SUBJECTS for endpoint in subject.endpoints(knowledge)]
