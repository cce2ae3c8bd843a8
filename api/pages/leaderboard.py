"""/leaderboard: the best of every architecture on all boards, and what comes near the bound."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from fastapi import Query
from pydantic import Field

from api.metadata import schema_org
from api.metadata.identity import identity
from api.metadata.signposting import landing_of_record
from api.pages.sensors import best_built
from api.pages.serving import PageRouter, View
from api.schema.base import Question
from api.schema.boards import BestOfArchitecture
from api.schema.parameters import GIVEN
from api.schema.table import columns_of
from api.service.documents import Document
from api.web.dependencies import Known
from benchmark.leaderboard.architectures import order_of_heights
from benchmark.leaderboard.overview import ROLES, overview
from benchmark.leaderboard.summaries import tally

router = PageRouter()

Row = Mapping[str, Any]

#: What rows are put in order by, and the column; names where there is none.
ORDERS = {"error": "own_error_deg", "bound": "over_bound", "name": None}


class LeaderboardQuery(Question):
    """In which order."""

    order: Annotated[Literal["error", "bound", "name"] | None, GIVEN] = Field(
        None, description="By the error, which is the default, by it over the bound, or by name."
    )


@router.page("/leaderboard")
async def leaderboard(known: Known, query: Annotated[LeaderboardQuery, Query()]) -> View:
    """Every architecture by its best pipeline, and the parts of pipelines.

    As CSV: the architectures, with the columns of `/v1/leaderboard/architectures`.
    """
    order = query.order or "error"
    rows = _order(best_built(known), ORDERS[order])
    document = {"items": rows, **overview(known.measurements.leaderboard)}
    landing = landing_of_record(identity())
    return View(
        "leaderboard.html",
        Document(document, columns_of(BestOfArchitecture), lambda: rows),
        landing=landing,
        entity=schema_org.record(identity(), landing, known.measurements.digest),
        order=order,
        tally=tally(rows),
        heights=(found := order_of_heights(rows)) and found.sentence,
        roles=ROLES,
        record=known.measurements.record,
    )


def _order(rows: Sequence[Row], column: str | None) -> list[Row]:
    """Return rows by a column, those without a number last; as they are where there is none."""
    if column is None:
        return list(rows)
    return sorted(rows, key=lambda row: (row[column] is None, row[column] or 0.0))
