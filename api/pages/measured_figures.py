"""/figures/gap, /figures/trade-off, /figures/robustness: figures of measurements."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any
from urllib.parse import urlencode

from fastapi import Query

from api.figures import gap as gap_of
from api.figures import robustness as robustness_of
from api.figures import trade_off as trade_off_of
from api.figures.figure import Figure
from api.pages.serving import PageRouter, View
from api.schema import words
from api.schema.measured_figures import GapQuery, RobustnessQuery, TradeOffQuery
from api.service.documents import Document
from api.service.gap import gap as gap_document
from api.service.gap import gap_drawn
from api.service.knowledge import Knowledge
from api.service.robustness import robustness as robustness_document
from api.service.trade_off import trade_off as trade_off_document
from api.web.dependencies import Known
from registry.requirements import HAZARDS

router = PageRouter()

LISTED = (
    ("/figures/gap", gap_of.TITLE, "Reported, in flight, own and bound on one axis."),
    (
        "/figures/trade-off",
        trade_off_of.TITLE,
        "Error against field, height, poses, time, power or mass, with the frontier.",
    ),
    (
        "/figures/robustness",
        robustness_of.TITLE,
        "Extractors and models by condition, and two of them on every board.",
    ),
)
"""Address, title and caption of each figure of measurements."""


@dataclass(frozen=True)
class Choice:
    """A parameter of the address as select boxes; `nothing` is the word for none chosen."""

    name: str
    label: str
    words: Sequence[str]
    chosen: Sequence[str]
    nothing: str = "any"
    boxes: int = 1


@router.page("/figures/gap", figures=True)
async def gap(known: Known, query: Annotated[GapQuery, Query()]) -> View:
    """Show reported accuracy, error in flight, own error and bound of every architecture."""
    levels = ("flight", "own", "bound", "reported")
    choices = [
        Choice("level", "Order by", levels, [query.level], ""),
        *_values(known, query, "detector", "mask", "task", "error"),
    ]
    kept = [("edition", "all")] if query.edition == "all" else []
    return _view(gap_document(known, query), choices, kept=kept)


@router.page("/figures/trade-off", figures=True)
async def trade_off(known: Known, query: Annotated[TradeOffQuery, Query()]) -> View:
    """Error against a cost, with the frontier."""
    axes, errors = trade_off_of.AXES, trade_off_of.ERRORS
    choices = [
        Choice("across", "Against", tuple(axes), [query.across], ""),
        Choice("level", "Error", tuple(errors), [query.level or ""], "usual"),
        *_values(known, query, "detector", "mask"),
        Choice("dataset", "Data set", words.datasets(), query.dataset),
        Choice("extractor", "Extractor", words.extractors(), query.extractor),
        Choice("model", "Model", words.models(), query.model),
    ]
    asked = query.model_dump(exclude_defaults=True)

    def selecting(name: str) -> str:
        """Return the address with a row selected, or not any more."""
        chosen = sorted({*query.select} ^ {name})
        return f"/figures/trade-off?{urlencode({**asked, 'select': chosen}, doseq=True)}"

    return _view(
        trade_off_document(known, query),
        choices,
        kept=[("select", name) for name in query.select],
        axis=axes[query.across],
        errors=errors,
        selecting=selecting,
        page_of=trade_off_of.page_of,
    )


@router.page("/figures/robustness", figures=True)
async def robustness(known: Known, query: Annotated[RobustnessQuery, Query()]) -> View:
    """Multiples of the bound by condition, and two methods on every board."""
    names = sorted(words.extractors() if query.rows == "extractor" else words.models())

    def several(name: str, label: str, all_words: Sequence[str], chosen: Sequence[str]) -> Choice:
        return Choice(name, label, all_words, chosen, "none", max(2, len(chosen)))

    choices = [
        Choice("rows", "Rows", ("extractor", "model"), [query.rows], ""),
        several("hazard", "Hazard", tuple(HAZARDS), query.hazard),
        several("condition", "Condition", words.conditions(), query.condition),
        *_values(known, query, "detector", "mask"),
        several("compare", "Compare", names, query.compare),
    ]
    found = robustness_document(known, query)
    return _view(found, choices, grid=robustness_of.grid(found.rows()))


def gap_section(known: Knowledge, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the macro `parts.gap` takes: the gap of a part of the architectures."""
    query = GapQuery.model_validate(asked)
    stated = query.model_dump(exclude_defaults=True)
    return {"gap": gap_drawn(known, query), "gap_query": urlencode(stated, doseq=True)}


def _view(found: Document, choices: Sequence[Choice], **more: Any) -> View:
    figure = Figure(
        name=found.document["figure"],
        title=found.document["title"],
        caption=found.document["caption"],
        text=tuple(found.document["text"]),
        columns=tuple(found.columns),
        rows=tuple(found.rows()),
        plotly=found.plotly or {},
    )
    context = {"kept": (), **more, "figure": figure, "choices": choices}
    return View("measured_figure.html", found, figures=(figure,), **context)


def _values(known: Knowledge, query: Any, *names: str) -> Iterator[Choice]:
    """Yield attributes of the taxonomy as select boxes."""
    for name in names:
        label = "Source of error" if name == "error" else name.capitalize()
        yield Choice(name, label, known.taxonomy.values(name), getattr(query, name))
