"""The routers, one module a subject."""

from __future__ import annotations

from api.http.routers import (
    about,
    algorithms,
    assessment,
    datasets,
    flows,
    leaderboard,
    page,
    realism,
    recommendations,
    results,
    studies,
    sweeps,
    taxonomy,
)

ROUTERS = tuple(
    subject.router
    for subject in (
        taxonomy,
        studies,
        flows,
        recommendations,
        algorithms,
        datasets,
        realism,
        results,
        leaderboard,
        sweeps,
        assessment,
        about,
        page,
    )
)
"""In the order of the documentation."""
