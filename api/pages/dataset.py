"""/datasets and /datasets/{name}: readings, leaderboard, error over the field, description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from fastapi import Path, Query
from pydantic import Field

from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.metadata import schema_org
from api.metadata.identity import identity
from api.metadata.served import MEASURED
from api.pages import boards
from api.pages.heat import heat_map
from api.pages.serving import PageRouter, View
from api.real.scores import beside_standard
from api.real.sets import SETS
from api.schema import words
from api.schema.base import Question
from api.schema.datasets import DatasetsQuery
from api.schema.parameters import GIVEN
from api.service import datasets as service
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.metadata import landing_of_dataset
from api.service.problems import Problem, Violation
from api.web.dependencies import Known
from benchmark.error_budget import sentences
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.leaderboard.architectures import architectures as best_of_each
from benchmark.metrics.score import AVAILABLE
from benchmark.results import samples
from survey_data.nearest import nearest_name

router = PageRouter()

EVERY = 500
FIRST = 8  # rows of a board that are shown at first
WARM = 20  # pipelines of the heat map
BOARD_COLUMNS = (
    *(
        "dataset",
        "condition",
        "rank",
        "group",
        "tied",
        "extractor",
        "model",
        "status",
        "own_error_deg",
    ),
    *("on_bench_deg", "twin_of", "folded", "rms_deg", "bound_deg", "over_bound", "availability"),
    *(
        "false_detection_rate",
        "repeatability_deg",
        "low_deg",
        "high_deg",
        "studies",
        "best_of_extractor",
    ),
)


class BoardQuery(Question):
    """Which board of a data set."""

    condition: Annotated[words.Condition | None, GIVEN] = Field(
        None, description="The first by default."
    )
    rows: Annotated[Literal["first", "all"] | None, GIVEN] = Field(
        None, description="The first rows of the board, or all."
    )


@router.page("/datasets")
async def datasets(known: Known) -> View:
    """Every standard data set with its leader."""
    answer = service.datasets(known, DatasetsQuery.model_validate({"limit": EVERY}))
    leaders: dict[str, Mapping[str, Any]] = {}
    for row in boards.first_rows(known):
        if row["rank"] == 1:
            leaders.setdefault(row["dataset"], row)
    finer = {
        board["name"]: best
        for board in known.measurements.leaderboard["datasets"]
        for best in best_of_each({"datasets": [board]})
    }
    real = [(one, beside_standard(name, known.measurements.nominal)) for name, one in SETS.items()]
    return View(
        "datasets.html", answer, leaders=leaders, finer=finer, available=AVAILABLE, real=real
    )


@router.page("/datasets/{name}", figures=True)
async def dataset(
    known: Known, name: Annotated[words.DatasetName, Path()], query: Annotated[BoardQuery, Query()]
) -> View:
    """One data set; its twins are its card with the board of the condition."""
    card = known.measurements.card(name)
    condition = query.condition or card["conditions"][0]
    if condition not in card["conditions"]:
        near = nearest_name(condition, card["conditions"])
        expected = f"one of {', '.join(card['conditions'])}"
        error = Violation("condition", condition, expected, near)
        raise Problem(422, "invalid-value", errors=[error])
    every = known.measurements.board_rows(name)
    board = [row for row in every if row["condition"] == condition]
    unfolded = [row for row in board if not (row["folded"] or row["twin_of"])]
    shown = board if query.rows == "all" else unfolded[:FIRST]
    every_board = known.measurements.leaderboard["datasets"]
    document = {**card, "condition": condition, "board": board}
    held = ERROR_BUDGET.read().get(name)
    realism = next((r for r in known.measurements.realism if r["dataset"] == name), None)
    ours = realism and known.measurements.nominal.get(
        (name, realism["extractor"], realism["model"])
    )
    landing = landing_of_dataset(known, name)
    field, curve = _field(board), _curve(known, name)
    return View(
        "dataset.html",
        Document(document, BOARD_COLUMNS, lambda: board),
        landing=landing,
        entity=schema_org.dataset(card, identity(), landing, MEASURED),
        condition=condition,
        shown=shown,
        sampled=samples.has_samples(name, known.measurements.directory),
        figures=(field, curve),
        field=field,
        heat=heat_map(every, card["conditions"], condition, WARM),
        curve=curve,
        held=sentences.verdict(held).sentence if held else None,
        tried=[(d, one) for d in known.measurements.directions for one in _told(d, name)],
        facts=next((one for one in every_board if one["name"] == name), None),
        realism=realism,
        ours=ours,
    )


def _told(direction: Mapping[str, Any], name: str) -> list[Mapping[str, Any]]:
    """Return what a direction's two families of methods did on a data set, where they differ."""
    return [one for one in direction["duels"] if one["dataset"] == name and one["outcome"] != "tie"]


def _field(board: Sequence[Mapping[str, Any]]) -> Figure:
    best = [row for row in board if row["best_of_extractor"]][: boards.MOST_LINES]
    named = [{**row, "name": f"{row['extractor']} + {row['model']}"} for row in best]
    return boards.field_chart(named, "name")


def _curve(known: Knowledge, name: str) -> Figure:
    rows = [row for row in known.measurements.curves if row["dataset"] == name]
    lines = [
        Line(
            f"{row['extractor']} + {row['model']}",
            [(point["poses"], point["middle_deg"]) for point in row["points"]],
            [(p["poses"], p["least_deg"] or None, p["largest_deg"]) for p in row["points"]],
        )
        for row in rows
    ]
    return line_figure(
        "poses",
        f"Error of the leaders on {name} against the number of calibration poses",
        lines,
        "calibration poses",
        "RMS, °",
        log_across=True,
    )
