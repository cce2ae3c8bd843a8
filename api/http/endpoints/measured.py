"""/v1/datasets, /v1/results and /v1/leaderboard: what is measured, and on what."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api.http.answers import Answer
from api.http.endpoint import Endpoint, PathPart
from api.http.knowledge import Knowledge
from api.http.pagination import CURSOR, LIMIT, page
from api.http.parameters import Arguments, Parameter, Parameters
from api.http.shapes_measured import DatasetDetail, Datasets, Leaderboard, LeaderboardRows, Scores
from api.http.values import Choice, PositiveNumber
from benchmark.leaderboard.board import at_field, within_error
from benchmark.metrics.rings import EDGES_DEG

DATASET_COLUMNS = ("name", "version", "detector", "mask", "observation", "conditions")
DATA_COLUMNS = ("condition", "split", "samples", "data_hash", "bound_deg")
SCORE_COLUMNS = ("dataset", "condition", "extractor", "model", "status", "rms_deg", "bound_deg")
RANK_COLUMNS = (
    *("rank", "tied", "dataset", "condition", "extractor", "model", "rms_deg", "bound_deg"),
    *("low_deg", "high_deg", "availability", "false_sun"),
)
FIELDS = tuple(str(edge) for edge in EDGES_DEG[1:])


def endpoints(knowledge: Knowledge) -> list[Endpoint]:
    """Return the endpoints of measurements."""
    measurements = knowledge.measurements
    narrowing = [
        Parameter(
            "condition", Choice(lambda: measurements.conditions), "Only this condition.", True
        ),
        Parameter(
            "extractor",
            Choice(lambda: tuple(knowledge.catalogue.extractors)),
            "Only this extractor, by the name of its implementation.",
            repeatable=True,
        ),
        Parameter(
            "model",
            Choice(lambda: tuple(knowledge.catalogue.models)),
            "Only this model, by the name of its implementation.",
            repeatable=True,
        ),
    ]
    dataset = Parameter(
        "dataset", Choice(lambda: measurements.dataset_names), "Only this data set.", True
    )
    of_list = Parameters([LIMIT, CURSOR])
    of_results = Parameters([dataset, *narrowing, LIMIT, CURSOR])
    field = Parameter(
        "field_deg",
        Choice(lambda: FIELDS),
        "Rank by the error within this angle of the boresight, degrees: rings of the field count "
        "by their solid angle, so that sensors compare at an equal field.",
    )
    largest = Parameter(
        "max_error_deg",
        PositiveNumber(180.0),
        "Rank by the widest field in whose every ring the RMS error stays within this, degrees.",
    )
    of_board = Parameters([*narrowing, field, largest, LIMIT, CURSOR])

    def listing(
        rows: Sequence[Mapping[str, Any]],
        columns: Sequence[str],
        path: str,
        parameters: Parameters,
        arguments: Arguments,
    ) -> Answer:
        shown = page(rows, path, parameters, arguments)
        document = {"items": shown.items, "total": shown.total, "next": shown.next}
        return Answer(document, columns, lambda: shown.items, shown.link)

    def build_datasets(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        return listing(measurements.cards, DATASET_COLUMNS, "/v1/datasets", of_list, arguments)

    def build_dataset(parts: Mapping[str, str], _arguments: Arguments) -> Answer:
        card = measurements.card(parts["name"])
        return Answer(card, DATA_COLUMNS, lambda: card["data"])

    def build_results(_parts: Mapping[str, str], arguments: Arguments) -> Answer:
        rows = [row for row in measurements.scores if _wanted(row, arguments)]
        return listing(rows, SCORE_COLUMNS, "/v1/results", of_results, arguments)

    def build_leaderboard(_parts: Mapping[str, str], _arguments: Arguments) -> Answer:
        board = {k: v for k, v in measurements.leaderboard.items() if k != "sweeps"}
        return Answer(board, RANK_COLUMNS, measurements.board_rows)

    def build_board(parts: Mapping[str, str], arguments: Arguments) -> Answer:
        name = parts["dataset"]
        ranked = measurements.board_rows(name)
        if arguments["field_deg"]:
            ranked = at_field(ranked, int(arguments["field_deg"]))
        if arguments["max_error_deg"]:
            ranked = within_error(ranked, arguments["max_error_deg"])
        rows = [row for row in ranked if _wanted(row, arguments)]
        return listing(rows, RANK_COLUMNS, f"/v1/leaderboard/{name}", of_board, arguments)

    return [
        Endpoint(
            path="/v1/datasets",
            name="datasets",
            summary="The standard data sets",
            description="Short cards of the simulated data sets every pipeline is scored on.",
            shape=Datasets,
            build=build_datasets,
            parameters=of_list,
            example_arguments="limit=1",
        ),
        Endpoint(
            path="/v1/datasets/{name}",
            name="dataset",
            summary="One data set",
            description="Its card: geometry, conditions with every parameter that the numbers "
            "depend on, seeds, the bound of each condition, the hash of each split, and where its "
            "picture is. As CSV: the hashes and bounds.",
            shape=DatasetDetail,
            build=build_dataset,
            parts=(dataset_name(knowledge),),
            example={"name": "cmos-single-aperture"},
        ),
        Endpoint(
            path="/v1/results",
            name="results",
            summary="The scores",
            description="One row a data set, condition, extractor and model, failures included.",
            shape=Scores,
            build=build_results,
            parameters=of_results,
            example_arguments="limit=1",
        ),
        Endpoint(
            path="/v1/leaderboard",
            name="leaderboard",
            summary="The leaderboard",
            description="Every data set and condition: pipelines ranked by error, those that "
            "answer less than 95 % behind all others; a rank is shared where errors on five units "
            "built alike overlap. Sweeps are at /v1/sweeps.",
            shape=Leaderboard,
            build=build_leaderboard,
        ),
        Endpoint(
            path="/v1/leaderboard/{dataset}",
            name="leaderboard_of_dataset",
            summary="The leaderboard of a data set",
            description="Rows of one data set's leaderboard, best first within a condition; with "
            "`field_deg` by the error over a part of the field, with `max_error_deg` by the field "
            "that keeps an error.",
            shape=LeaderboardRows,
            build=build_board,
            parameters=of_board,
            parts=(
                PathPart("dataset", "Name of the data set.", lambda: measurements.dataset_names),
            ),
            example={"dataset": "cmos-single-aperture"},
            example_arguments="limit=1",
        ),
    ]


def dataset_name(knowledge: Knowledge) -> PathPart:
    """Return the part of a path that names a data set."""
    names = knowledge.measurements
    return PathPart("name", "Name of the data set.", lambda: names.dataset_names)


def _wanted(row: Mapping[str, Any], arguments: Arguments) -> bool:
    """Say whether a row has one of the wanted words of every field that is narrowed."""
    fields = ("dataset", "condition", "extractor", "model")
    return all(row.get(name) in arguments[name] for name in fields if arguments.get(name))
