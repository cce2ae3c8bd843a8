"""/v1/leaderboard: the scores ranked."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.schema.base import Selected
from api.schema.boards import (
    Architectures,
    ArchitecturesQuery,
    Overview,
    OverviewQuery,
)
from api.schema.scores import (
    Leaderboard,
    LeaderboardQuery,
    LeaderboardRows,
    WholeLeaderboardQuery,
)
from api.schema.words import DatasetName
from api.service import leaderboard as service
from api.web.answers import Answer, AnswerRoute
from api.web.dependencies import Known

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/leaderboard",
    summary="Leaderboard",
    response_model=Leaderboard,
)
async def leaderboard(known: Known, query: Annotated[WholeLeaderboardQuery, Query()]) -> Answer:
    """Return the leaderboards of all data sets and conditions.

    Pipelines are ranked by error, the best of each extractor first. Pipelines below 95 %
    availability rank last. Ranks are shared if a paired test over sensor units cannot separate
    them. `whole` returns all rows at once.
    """
    return Answer.of(service.leaderboard(known, query))


@router.get(
    "/leaderboard/architectures",
    summary="Best pipeline of each architecture",
    response_model=Architectures | Selected,
)
async def architectures(known: Known, query: Annotated[ArchitecturesQuery, Query()]) -> Answer:
    """Return the best pipeline of each architecture, with its bound and its uncertainty.

    Uncertainty: standard error of the ratio to the bound, errors on other sensor units, and ties
    with the runner-up.
    """
    return Answer.of(service.architectures(known, query))


@router.get(
    "/leaderboard/overview",
    summary="Ratio to the bound by part of the pipeline",
    response_model=Overview,
)
async def overview(known: Known, query: Annotated[OverviewQuery, Query()]) -> Answer:
    """Return how often each extractor, compensation and model is near the bound, over data sets.

    `says` describes the aggregation. CSV: a row per part.
    """
    return Answer.of(service.overview(known, query))


@router.get(
    "/leaderboard/{dataset}",
    summary="Leaderboard of a data set",
    response_model=LeaderboardRows | Selected,
)
async def leaderboard_of_dataset(
    known: Known,
    dataset: Annotated[
        DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
    ],
    query: Annotated[LeaderboardQuery, Query()],
) -> Answer:
    """Return the leaderboard of a data set.

    `field_deg` ranks by the error over part of the field, `max_error_deg` by the field of view for
    a maximum error.
    """
    return Answer.of(service.leaderboard_of_dataset(known, dataset, query))
