"""/v1/leaderboard: the scores ranked."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api import columns
from api.deposit.identity import identity
from api.http.answers import Answer, AnswerRoute, listing
from api.http.dependencies import AS_ACCEPTED, Known, TableOnly
from api.http.models.base import Selected
from api.http.models.boards import (
    Architectures,
    ArchitecturesQuery,
    Overview,
    OverviewQuery,
)
from api.http.models.scores import Leaderboard, LeaderboardQuery, LeaderboardRows
from api.http.models.words import DatasetName
from api.http.pagination import narrowed, ordered, page
from api.metadata.signposting import headers, landing_of_record
from benchmark.leaderboard.architectures import architectures as best_of_each
from benchmark.leaderboard.board import at_field, within_error
from benchmark.leaderboard.overview import overview as overview_of

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)


@router.get(
    "/leaderboard",
    summary="The leaderboard",
    response_model=Leaderboard,
)
async def leaderboard(
    known: Known,
    query: TableOnly = AS_ACCEPTED,  # noqa: ARG001 - the route has read it
) -> Answer:
    """Every data set and condition: pipelines ranked by error, the best of each extractor first.

    Those that answer less than 95 % come behind all others; a rank is shared where errors on five
    units built alike overlap. Sweeps are at /v1/sweeps.
    """
    board = {k: v for k, v in known.measurements.leaderboard.items() if k != "sweeps"}
    board["record"] = known.measurements.record
    link = ", ".join(headers(landing_of_record(identity()).links_of_content()))
    return Answer(board, columns.LEADERBOARD, known.measurements.board_rows, link)


@router.get(
    "/leaderboard/architectures",
    summary="The best pipeline of each architecture",
    response_model=Architectures | Selected,
)
async def architectures(known: Known, query: Annotated[ArchitecturesQuery, Query()]) -> Answer:
    """How far the best pipeline of each detector and mask is from its bound, and how sure that is.

    How sure: by the standard error of its ratio to the bound, by its errors on other units of the
    sensor, and by whether the pipeline that ranks next is within either.
    """
    rows = narrowed(best_of_each(known.measurements.leaderboard), query, ("detector", "mask"))
    shown = page(ordered(rows, query.sort), "/v1/leaderboard/architectures", query)
    return listing(shown, shown.items, columns.ARCHITECTURES, fields=query.fields)


@router.get(
    "/leaderboard/overview",
    summary="How near the bound each part of a pipeline comes",
    response_model=Overview,
)
async def overview(known: Known, query: Annotated[OverviewQuery, Query()]) -> Answer:
    """Share of the data sets on which each extractor, compensation and model comes near its bound.

    `says` tells in words how it aggregates. As CSV: a row a part.
    """
    board = known.measurements.leaderboard
    boards = narrowed(board["datasets"], query, ("detector", "mask"))
    document = overview_of({"datasets": boards})
    parts = narrowed(document["parts"], query, ("role",))
    return Answer({**document, "parts": parts}, columns.PARTS, lambda: parts)


@router.get(
    "/leaderboard/{dataset}",
    summary="The leaderboard of a data set",
    response_model=LeaderboardRows | Selected,
)
async def leaderboard_of_dataset(
    known: Known,
    dataset: Annotated[
        DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
    ],
    query: Annotated[LeaderboardQuery, Query()],
) -> Answer:
    """Rows of one data set's leaderboard, within a condition the best of each extractor first.

    `field_deg` ranks by the error over a part of the field, `max_error_deg` by the field that keeps
    an error.
    """
    ranked = known.measurements.board_rows(dataset)
    if query.field_deg is not None:
        ranked = at_field(ranked, int(query.field_deg))
    if query.max_error_deg is not None:
        ranked = within_error(ranked, query.max_error_deg)
    rows = [
        row
        for row in narrowed(ranked, query, ("condition", "extractor", "model"))
        if row["best_of_extractor"] >= query.best_of_extractor
        and bool(row["studies"]) >= query.studied
    ]
    shown = page(ordered(rows, query.sort), f"/v1/leaderboard/{dataset}", query)
    return listing(shown, shown.items, columns.LEADERBOARD, fields=query.fields)
