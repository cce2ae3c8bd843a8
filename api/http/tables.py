"""Every document of the service that can be a table too: its address, its model, its function.

A new one is a row here; parameters and description are those of the function.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from typing import Annotated, Any, get_type_hints

from fastapi import APIRouter, Body, Path, Query

from api.schema import advice as of_advice
from api.schema import algorithms as of_algorithms
from api.schema import assessment as of_assessment
from api.schema import boards as of_boards
from api.schema import claims as of_claims
from api.schema import comparison as of_comparison
from api.schema import curves as of_curves
from api.schema import datasets as of_datasets
from api.schema import directions as of_directions
from api.schema import figures as of_figures
from api.schema import flows as of_flows
from api.schema import measured_figures as of_measured
from api.schema import recommendations as of_recommendations
from api.schema import samples as of_samples
from api.schema import scores as of_scores
from api.schema import search as of_search
from api.schema import studies as of_studies
from api.schema import taxonomy as of_taxonomy
from api.schema.base import OnlyFormat, Selected
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


@dataclass(frozen=True)
class Table:
    """A document of the service at an address.

    Attributes
    ----------
    path : below /v1
    function : of the service; its docstring is the description
    model : of the document
    kind : the media types it can be had in
    """

    path: str
    function: Callable[..., Document]
    model: Any
    summary: str
    kind: type[Answer] = Answer
    method: str = "GET"


TABLES = (
    Table("/taxonomy", taxonomy.taxonomy, of_taxonomy.Taxonomy, "Vocabulary of the survey"),
    Table("/studies", studies.studies, of_studies.Studies | Selected, "Studies", CitedAnswer),
    Table("/editions", studies.editions, of_studies.Editions, "Editions of the studies"),
    Table("/studies/{key}", studies.study, of_studies.StudyDetail, "A study", CitedAnswer),
    Table("/flows/{chart}", taxonomy.flows, of_flows.Flows, "A decision flow"),
    Table("/figures", figures.figures, of_figures.Figures, "The survey's figures"),
    Table(
        "/figures/matrix",
        figures.matrix,
        of_figures.Figure,
        "Evidence map: studies by two attributes",
        FigureAnswer,
    ),
    Table(
        "/figures/gap",
        gap.gap,
        of_measured.Gap,
        "Claimed, simulated and possible errors",
        FigureAnswer,
    ),
    Table(
        "/figures/trade-off",
        trade_off.trade_off,
        of_measured.TradeOff,
        "Error against cost",
        FigureAnswer,
    ),
    Table(
        "/figures/robustness",
        robustness.robustness,
        of_measured.Robustness,
        "Errors by condition",
        FigureAnswer,
    ),
    Table(
        "/figures/{figure}",
        figures.figure,
        of_figures.Figure,
        "A figure of the survey",
        FigureAnswer,
    ),
    Table(
        "/recommendations",
        recommendations.recommendations,
        of_recommendations.Recommendations,
        "Recommended sensors and calibrations",
    ),
    Table(
        "/recommendations",
        recommendations.recommend,
        of_recommendations.Recommendations,
        "Recommended sensors and calibrations (requirements in the body)",
        method="POST",
    ),
    Table(
        "/recommendations/flow",
        recommendations.recommendations_flow,
        of_recommendations.AnswerFlow,
        "Decision flow of an answer",
    ),
    Table(
        "/recommendations/designs",
        recommendations.recommended_designs,
        of_recommendations.Designs,
        "All calibrations of an answer",
    ),
    Table(
        "/algorithms", algorithms.algorithms, of_algorithms.Algorithms | Selected, "Implementations"
    ),
    Table("/datasets", datasets.datasets, of_datasets.Datasets | Selected, "Data sets"),
    Table("/datasets/{name}", datasets.dataset, of_datasets.DatasetDetail, "A data set"),
    Table(
        "/datasets/{name}/errors",
        datasets.errors,
        of_samples.SampleErrors | Selected,
        "Errors of each sample",
    ),
    Table(
        "/realism", datasets.realism, of_datasets.Realism, "Data sets compared with built sensors"
    ),
    Table(
        "/realism/sold", datasets.as_sold, of_datasets.SoldSensors, "Built sensors as they are sold"
    ),
    Table("/results", scores.results, of_scores.Scores | Selected, "Scores"),
    Table("/leaderboard", leaderboard.leaderboard, of_scores.Leaderboard, "Leaderboard"),
    Table(
        "/leaderboard/architectures",
        leaderboard.architectures,
        of_boards.Architectures | Selected,
        "Best pipeline of each architecture",
    ),
    Table(
        "/leaderboard/overview",
        leaderboard.overview,
        of_boards.Overview,
        "Ratio to the bound by part of the pipeline",
    ),
    Table(
        "/leaderboard/{dataset}",
        leaderboard.leaderboard_of_dataset,
        of_scores.LeaderboardRows | Selected,
        "Leaderboard of a data set",
    ),
    Table(
        "/sweeps", scores.sweeps, of_assessment.Sweeps | Selected, "Sweeps on reference features"
    ),
    Table("/curves", scores.curves, of_curves.Curves | Selected, "Learning curves"),
    Table(
        "/assessment",
        assessment.assessment,
        of_assessment.Assessment,
        "Assessment of the survey, with measured scores",
    ),
    Table("/claims", claims.claims, of_claims.Claims | Selected, "Claims of the survey, tested"),
    Table("/claims/{id}", claims.claim, of_claims.ClaimDetail, "A claim"),
    Table(
        "/directions",
        directions.directions,
        of_directions.Directions,
        "Future directions of the survey, decided",
    ),
    Table("/compare", comparing.compare, of_comparison.Comparison, "Comparison"),
    Table(
        "/compare/equal",
        comparing.equal_heights,
        of_comparison.EqualHeights,
        "Masks at equal height, detector and field",
    ),
    Table("/search", search.search, of_search.SearchResults, "Search"),
    Table("/advice", advice.advice, of_advice.Advices | Selected, "The survey's advice"),
    Table("/protocol", advice.protocol, of_advice.Protocol, "Rules for studies and scores"),
)


def path_function(function: Callable[..., Document], kind: type[Answer] = Answer) -> Any:
    """Return a function of the service as FastAPI takes it, `known` and `query` among its own."""
    hints = get_type_hints(function, include_extras=True)
    hints.pop("return")
    taken = frozenset(hints)

    @wraps(function)
    async def answer(**given: Any) -> Answer:
        return kind.of(function(**{name: given[name] for name in taken}))

    types: dict[str, Any] = {name: _part(name, hint) for name, hint in hints.items()}
    types["known"] = Known
    unasked = of_studies.StudyQuery if kind is CitedAnswer else OnlyFormat
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
