"""/v1/leaderboard: the scores ranked."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Query

from api.http.answers import Answer, AnswerRoute, listing
from api.http.dependencies import NO_PARAMETERS, Known
from api.http.models.scores import Leaderboard, LeaderboardQuery, LeaderboardRows
from api.http.models.words import DatasetName
from api.http.pagination import narrowed, page
from benchmark.leaderboard.board import at_field, within_error

router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)

COLUMNS = (
    *("rank", "tied", "dataset", "condition", "extractor", "model", "rms_deg", "bound_deg"),
    *("bound_unit_deg", "floor_deg", "low_deg", "high_deg", "availability", "false_sun"),
)


@router.get(
    "/leaderboard",
    summary="The leaderboard",
    response_model=Leaderboard,
    dependencies=[NO_PARAMETERS],
)
async def leaderboard(known: Known) -> Answer:
    """Every data set and condition: pipelines ranked by error.

    Those that answer less than 95 % come behind all others; a rank is shared where errors on five
    units built alike overlap. Sweeps are at /v1/sweeps.
    """
    board = {k: v for k, v in known.measurements.leaderboard.items() if k != "sweeps"}
    return Answer(board, COLUMNS, known.measurements.board_rows)


@router.get(
    "/leaderboard/{dataset}",
    summary="The leaderboard of a data set",
    response_model=LeaderboardRows,
)
async def leaderboard_of_dataset(
    known: Known,
    dataset: Annotated[
        DatasetName, Path(description="Name of the data set.", examples=["cmos-single-aperture"])
    ],
    query: Annotated[LeaderboardQuery, Query()],
) -> Answer:
    """Rows of one data set's leaderboard, best first within a condition.

    `field_deg` ranks by the error over a part of the field, `max_error_deg` by the field that keeps
    an error.
    """
    ranked = known.measurements.board_rows(dataset)
    if query.field_deg is not None:
        ranked = at_field(ranked, int(query.field_deg))
    if query.max_error_deg is not None:
        ranked = within_error(ranked, query.max_error_deg)
    rows = narrowed(ranked, query, ("condition", "extractor", "model"))
    shown = page(rows, f"/v1/leaderboard/{dataset}", query)
    return listing(shown, shown.items, COLUMNS)
