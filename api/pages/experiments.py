"""/experiments and /experiments/{name}: what is measured beside the scores, one page for all."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import getdoc
from pathlib import PurePosixPath
from typing import Annotated, Any

from fastapi import APIRouter, Path

from api.pages.serving import PageRouter, View
from api.schema.parameters import OneOf
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.service.problems import Problem
from api.web.answers import AnswerRoute, Drawing
from api.web.dependencies import NO_PARAMETERS, Known
from benchmark.running.experiment import RecordedExperiment, recorded_experiments

router = PageRouter()
#: Rows that a page shows; its CSV has all.
SHOWN = 100

Name = Annotated[str, OneOf(lambda: tuple(recorded_experiments())), Path()]

pictures = APIRouter(route_class=AnswerRoute, include_in_schema=False)


@router.page("/experiments")
async def experiments(known: Known) -> View:
    """List the experiments with the number of their rows."""
    every = [_about(_experiment(name, known)) for name in recorded_experiments()]
    columns = ("name", "title", "description", "rows")
    return View("experiments/list.html", Document({"items": every}, columns, lambda: every))


@router.page("/experiments/{name}")
async def experiment(known: Known, name: Name) -> View:
    """Show an experiment: what it measures, its pictures and its table; its JSON has whole rows."""
    found = _experiment(name, known)
    table = found.table()
    columns = tuple(dict.fromkeys(column for row in table for column in row))
    document = {**_about(found), "pictures": list(_drawn(found)), "items": found.rows()}
    return View(
        "experiments/one.html",
        Document(document, columns, lambda: table),
        table=table,
        columns=columns,
        most=SHOWN,
    )


@pictures.get("/experiments/{name}/{file}", response_class=Drawing, dependencies=[NO_PARAMETERS])
def picture(known: Known, name: Name, file: str) -> Drawing:
    """Draw a picture of an experiment."""
    draw = _drawn(_experiment(name, known)).get(file)
    if draw is None:
        raise Problem(404, "unknown-file", f"{name} has no picture {file}")
    return Drawing(draw())


def _experiment(name: str, known: Knowledge) -> RecordedExperiment[Any]:
    return recorded_experiments()[name](known.measurements.directory)


def _about(one: RecordedExperiment[Any]) -> dict[str, Any]:
    said = (getdoc(type(one)) or "").partition("\n\n")[0].replace("\n", " ")
    return {"name": one.name, "title": one.title, "description": said, "rows": len(one.rows())}


def _drawn(one: RecordedExperiment[Any]) -> Mapping[str, Callable[[], str]]:
    return {PurePosixPath(path).name: draw for path, draw in one.pictures().items()}
