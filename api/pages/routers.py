"""The page kinds, one module each; a new one is added here."""

from __future__ import annotations

from api.pages import (
    algorithm,
    bibliography,
    calibrate,
    claim,
    compare,
    dataset,
    directions,
    experiments,
    figures,
    glossary_page,
    leaderboard,
    measured_figures,
    reference,
    search,
    sensors,
    study,
)
from api.pages.home import answer

ROUTERS = (
    *(
        kind.router
        for kind in (
            *(answer, study, algorithm, dataset, sensors, claim, directions, compare, search),
            *(glossary_page, leaderboard, bibliography, calibrate, experiments),
            *(measured_figures, figures, reference),
        )
    ),
    experiments.pictures,
)
"""Routers of every kind of page."""
