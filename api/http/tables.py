"""Every document of the service that can be a table too: its address, its model, its function.

A new one is a row here; parameters and description are those of the function.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Annotated, Any, NamedTuple, get_type_hints

from fastapi import APIRouter, Body, Path, Query

from api.schema.advice import Advices, Protocol
from api.schema.algorithms import Algorithms
from api.schema.assessment import Assessment, Sweeps
from api.schema.base import OnlyFormat, Selected
from api.schema.boards import Architectures, Overview
from api.schema.claims import ClaimDetail, Claims
from api.schema.comparison import Comparison, EqualHeights
from api.schema.curves import Curves
from api.schema.datasets import DatasetDetail, Datasets, Realism, SoldSensors
from api.schema.directions import Directions
from api.schema.figures import Figure, Figures
from api.schema.flows import Flows, Taxonomy
from api.schema.measured_figures import Gap, Robustness, TradeOff
from api.schema.recommendations import AnswerFlow, Designs, Recommendations
from api.schema.samples import SampleErrors
from api.schema.scores import Leaderboard, LeaderboardRows, Scores
from api.schema.search import SearchResults
from api.schema.studies import Editions, Studies, StudyDetail, StudyQuery
from api.service import (
    advice,
    algorithms,
    assessment,
    claims,
    comparing,
    datasets,
    directions,
    figures,
    gap,
    leaderboard,
    recommendations,
    robustness,
    scores,
    search,
    studies,
    taxonomy,
    trade_off,
)
from api.service.documents import Document
from api.web.answers import Answer, AnswerRoute, CitedAnswer, FigureAnswer
from api.web.dependencies import Known

#: Parts of paths: what they are, and an example.
_PARTS = {
    "name": ("Name of the data set.", "cmos-single-aperture"),
    "dataset": ("Name of the data set.", "cmos-single-aperture"),
    "key": ("Key of the study.", "Chang2008"),
    "id": ("Claim, such as C29.", "C04"),
    "figure": ("Figure.", "performance"),
    "chart": ("Chart.", "error"),
}


class Table(NamedTuple):
    """A document at an address below /v1.

    Attributes
    ----------
    path : below /v1
    function : of the service; its docstring is the description
    model : of the document
    summary : its name in the reference
    kind : the media types it can be had in
    method : of HTTP
    """

    path: str
    function: Callable[..., Document]
    model: Any
    summary: str
    kind: type[Answer] = Answer
    method: str = "GET"


_ANSWERED = "Recommended sensors and calibrations"
TABLES = (
    Table("/taxonomy", taxonomy.taxonomy, Taxonomy, "Vocabulary of the survey"),
    Table("/studies", studies.studies, Studies | Selected, "Studies", CitedAnswer),
    Table("/editions", studies.editions, Editions, "Editions of the studies"),
    Table("/studies/{key}", studies.study, StudyDetail, "A study", CitedAnswer),
    Table("/flows/{chart}", taxonomy.flows, Flows, "A decision flow"),
    Table("/figures", figures.figures, Figures, "The survey's figures"),
    Table(
        "/figures/matrix",
        figures.matrix,
        Figure,
        "Evidence map: studies by two attributes",
        FigureAnswer,
    ),
    Table("/figures/gap", gap.gap, Gap, "Claimed, simulated and possible errors", FigureAnswer),
    Table("/figures/trade-off", trade_off.trade_off, TradeOff, "Error against cost", FigureAnswer),
    Table(
        "/figures/robustness",
        robustness.robustness,
        Robustness,
        "Errors by condition",
        FigureAnswer,
    ),
    Table("/figures/{figure}", figures.figure, Figure, "A figure of the survey", FigureAnswer),
    Table("/recommendations", recommendations.recommendations, Recommendations, _ANSWERED),
    Table(
        "/recommendations",
        recommendations.recommend,
        Recommendations,
        f"{_ANSWERED} (requirements in the body)",
        method="POST",
    ),
    Table(
        "/recommendations/flow",
        recommendations.recommendations_flow,
        AnswerFlow,
        "Decision flow of an answer",
    ),
    Table(
        "/recommendations/designs",
        recommendations.recommended_designs,
        Designs,
        "All calibrations of an answer",
    ),
    Table("/algorithms", algorithms.algorithms, Algorithms | Selected, "Implementations"),
    Table("/datasets", datasets.datasets, Datasets | Selected, "Data sets"),
    Table("/datasets/{name}", datasets.dataset, DatasetDetail, "A data set"),
    Table(
        "/datasets/{name}/errors", datasets.errors, SampleErrors | Selected, "Errors of each sample"
    ),
    Table("/realism", datasets.realism, Realism, "Data sets compared with built sensors"),
    Table("/realism/sold", datasets.as_sold, SoldSensors, "Built sensors as they are sold"),
    Table("/results", scores.results, Scores | Selected, "Scores"),
    Table("/leaderboard", leaderboard.leaderboard, Leaderboard, "Leaderboard"),
    Table(
        "/leaderboard/architectures",
        leaderboard.architectures,
        Architectures | Selected,
        "Best pipeline of each architecture",
    ),
    Table(
        "/leaderboard/overview",
        leaderboard.overview,
        Overview,
        "Ratio to the bound by part of the pipeline",
    ),
    Table(
        "/leaderboard/{dataset}",
        leaderboard.leaderboard_of_dataset,
        LeaderboardRows | Selected,
        "Leaderboard of a data set",
    ),
    Table("/sweeps", scores.sweeps, Sweeps | Selected, "Sweeps on reference features"),
    Table("/curves", scores.curves, Curves | Selected, "Learning curves"),
    Table(
        "/assessment",
        assessment.assessment,
        Assessment,
        "Assessment of the survey, with measured scores",
    ),
    Table("/claims", claims.claims, Claims | Selected, "Claims of the survey, tested"),
    Table("/claims/{id}", claims.claim, ClaimDetail, "A claim"),
    Table(
        "/directions", directions.directions, Directions, "Future directions of the survey, decided"
    ),
    Table("/compare", comparing.compare, Comparison, "Comparison"),
    Table(
        "/compare/equal",
        comparing.equal_heights,
        EqualHeights,
        "Masks at equal height, detector and field",
    ),
    Table("/search", search.search, SearchResults, "Search"),
    Table("/advice", advice.advice, Advices | Selected, "The survey's advice"),
    Table("/protocol", advice.protocol, Protocol, "Rules for studies and scores"),
)


def path_function(function: Callable[..., Document], kind: type[Answer] = Answer) -> Any:
    """Return a function of the service as FastAPI takes it, `known` and `query` among its own."""
    hints = get_type_hints(function, include_extras=True)
    hints.pop("return")
    taken = frozenset(hints)

    @wraps(function)
    async def answer(**given: Any) -> Answer:
        return kind(function(**{name: given[name] for name in taken}))

    types: dict[str, Any] = {name: _part(name, hint) for name, hint in hints.items()}
    types["known"] = Known
    unasked = StudyQuery if kind is CitedAnswer else OnlyFormat
    types["query"] = Annotated[hints.get("query", unasked), Query()]
    if body := hints.get("body"):
        types["body"] = Annotated[body, Body()]
    keyword = inspect.Parameter.KEYWORD_ONLY
    parameters = [inspect.Parameter(name, keyword, annotation=of) for name, of in types.items()]
    made: Any = answer
    made.__signature__ = inspect.Signature(parameters)
    made.__annotations__ = types
    del made.__wrapped__
    return made


def _part(name: str, hint: Any) -> Any:
    if name not in _PARTS:
        return hint
    said, example = _PARTS[name]
    return Annotated[hint, Path(description=said, examples=[example])]


router = APIRouter(prefix="/v1", route_class=AnswerRoute, default_response_class=Answer)
for one in TABLES:
    router.add_api_route(
        one.path,
        path_function(one.function, one.kind),
        methods=[one.method],
        response_model=one.model,
        response_class=one.kind,
        summary=one.summary,
    )
