"""The page kinds, one module each; a new one is added here."""

from __future__ import annotations

from api.pages import (
    algorithm,
    answer,
    bibliography,
    calibrate,
    claim,
    compare,
    dataset,
    experiments,
    figures,
    glossary_page,
    leaderboard,
    search,
    sensors,
    study,
)

ROUTERS = (
    *(
        kind.router
        for kind in (
            *(answer, study, algorithm, dataset, sensors, claim, compare, search),
            *(glossary_page, leaderboard, bibliography, calibrate, experiments),
        )
    ),
    *figures.ROUTERS,
    experiments.pictures,
)
"""Routers of every kind of page."""
