"""The routers, one module a subject."""

from __future__ import annotations

from api.http.routers import (
    about,
    advice,
    algorithms,
    assessment,
    calibrations,
    claims,
    compare,
    curves,
    datasets,
    figures,
    flows,
    guide,
    leaderboard,
    metadata,
    realism,
    recommendations,
    results,
    search,
    static_files,
    studies,
    sweeps,
    taxonomy,
)

ROUTERS = (
    metadata.router,  # before what takes its words for names of data sets
    metadata.root,
    *(
        subject.router
        for subject in (
            taxonomy,
            studies,
            flows,
            figures,
            recommendations,
            calibrations,
            algorithms,
            datasets,
            realism,
            results,
            leaderboard,
            sweeps,
            curves,
            assessment,
            claims,
            compare,
            search,
            advice,
            about,
            guide,
            static_files,
        )
    ),
)
"""In the order of the documentation."""
