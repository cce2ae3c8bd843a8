"""The scores ranked."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from api.metadata.identity import identity
from api.metadata.signposting import headers, landing_of_record
from api.schema.boards import ArchitecturesQuery, BestOfArchitecture, OverviewQuery, PartOverview
from api.schema.scores import LeaderboardQuery, LeaderboardRow, WholeLeaderboardQuery
from api.schema.table import columns_of
from api.schema.words import DatasetName
from api.service.documents import Document, listing
from api.service.knowledge import Knowledge
from api.service.pagination import Page, narrow, page
from benchmark.leaderboard.architectures import architectures as best_of_each
from benchmark.leaderboard.architectures import order_of_heights
from benchmark.leaderboard.board import at_field, within_error
from benchmark.leaderboard.overview import overview as overview_of
from registry.height_order import HeightOrder

if TYPE_CHECKING:
    from benchmark.leaderboard.findings import Finding


def leaderboard(known: Knowledge, query: WholeLeaderboardQuery) -> Document:
    """Return the leaderboards of all data sets and conditions.

    Pipelines are ranked by error, the best of each extractor first. Pipelines below 95 %
    availability rank last. Ranks are shared if a paired test over sensor units cannot separate
    them. `whole` returns all rows at once.
    """
    board = {k: v for k, v in known.measurements.leaderboard.items() if k != "sweeps"}
    rows = known.measurements.board_rows()
    shown = Page(rows, len(rows), None, None)
    if not query.whole:
        shown = page(rows, "/v1/leaderboard", query)
        board["datasets"] = _with_rows(board["datasets"], shown.items)
    board |= {"record": known.measurements.record, "total": shown.total, "next": shown.next}
    links = headers(landing_of_record(identity()).links_of_content())
    links = (*links, *([shown.link] if shown.link else ()))
    return Document(board, columns_of(LeaderboardRow), lambda: shown.items, links)


def _with_rows(
    boards: Iterable[Mapping[str, Any]], rows: Iterable[Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return boards with those of their rows that are among some."""
    of: dict[str, list[Mapping[str, Any]]] = {}
    for row in rows:
        of.setdefault(row["dataset"], []).append(row)
    return [{**board, "rows": of.get(board["name"], [])} for board in boards]


def architectures(known: Knowledge, query: ArchitecturesQuery) -> Document:
    """Return the best pipeline of each architecture, with its bound and its uncertainty.

    Uncertainty: standard error of the ratio to the bound, errors on other sensor units, and ties
    with the runner-up.
    """
    rows = narrow(best_of_each(known.measurements.leaderboard), query, ("detector", "mask"))
    heights = documented(order_of_heights(rows))
    path = "/v1/leaderboard/architectures"
    return listing(rows, path, query, BestOfArchitecture, height_order=heights)


def documented(found: HeightOrder | None) -> dict[str, Any] | None:
    """Return an order of heights as a member of a document."""
    return None if found is None else {**asdict(found), "sentence": found.sentence}


def overview(known: Knowledge, query: OverviewQuery) -> Document:
    """Return how often each extractor, compensation and model is near the bound, over data sets.

    `says` describes the aggregation. CSV: a row per part.
    """
    board = known.measurements.leaderboard
    boards = narrow(board["datasets"], query, ("detector", "mask"))
    document = overview_of({"datasets": boards})
    parts = narrow(document["parts"], query, ("role",))
    return Document({**document, "parts": parts}, columns_of(PartOverview), lambda: parts)


def leaderboard_of_dataset(
    known: Knowledge, dataset: DatasetName, query: LeaderboardQuery
) -> Document:
    """Return the leaderboard of a data set.

    `field_deg` ranks by the error over part of the field, `max_error_deg` by the field of view for
    a maximum error.
    """
    ranked = known.measurements.board_rows(dataset)
    if query.field_deg is not None:
        ranked = at_field(ranked, int(query.field_deg))
    if query.max_error_deg is not None:
        ranked = within_error(ranked, query.max_error_deg)
    rows = [
        row
        for row in narrow(ranked, query, ("condition", "extractor", "model"))
        if row["best_of_extractor"] >= query.best_of_extractor
        and bool(row["studies"]) >= query.studied
    ]
    return listing(rows, f"/v1/leaderboard/{dataset}", query, LeaderboardRow)


def findings(known: Knowledge) -> tuple[Finding, ...]:
    """Return the findings of the published record, which is of standard data sets."""
    from benchmark.leaderboard.findings import FindingsRecord, findings_of  # noqa: PLC0415 - needs every experiment

    return findings_of(FindingsRecord.published(), known.standard_resolutions)
