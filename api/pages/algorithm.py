"""/algorithms and /algorithms/{name}: what is implemented, and how well it does."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Annotated, Any

from fastapi import Path

from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.metadata import schema_org
from api.metadata.identity import identity
from api.metadata.signposting import landing_of_algorithm
from api.pages import boards
from api.pages.methods import docstring_parts
from api.pages.serving import PageRouter, View
from api.pages.terms import term_name
from api.schema.algorithms import Algorithm, AlgorithmsQuery
from api.schema.parameters import OneOf
from api.service import algorithms as service
from api.service.documents import Document
from api.service.knowledge import Knowledge
from api.web.dependencies import Known
from registry.catalogue import Implementation, catalogue

router = PageRouter()

EVERY = 500
SWEPT = (("noise", "peak SNR"), ("size", "feature size, px"), ("phase", "sub-pixel phase, px"))
ROLES = {"extractor": "Feature extractors", "model": "Calibration models"}


def _names() -> Sequence[str]:
    return [implementation.name for implementation in catalogue().implementations(None)]


Name = Annotated[str, OneOf(_names), Path()]


@router.page("/algorithms")
async def algorithms(known: Known) -> View:
    """Every implementation by role, family and value of the taxonomy, gaps included."""
    answer = service.algorithms(known, AlgorithmsQuery.model_validate({"limit": EVERY}))
    every = known.catalogue.implementations(None)
    best = boards.best_of(known)
    groups = [
        {
            "role": role,
            "title": title,
            "families": [
                {"name": family, "values": [_value(role, e, every) for e in entries]}
                for family, entries in groupby(
                    known.taxonomy.to_dict()[role], key=lambda e: e["category"]
                )
            ],
        }
        for role, title in ROLES.items()
    ]
    return View("algorithms.html", answer, groups=groups, best=best)


def _value(role: str, entry: Mapping[str, str], every: Sequence[Implementation]) -> dict[str, Any]:
    found = [i for i in every if i.role == role and i.taxonomy == entry["value"]]
    return {**entry, "name": term_name(entry["value"], role), "implementations": found}


@router.page("/algorithms/{name}", figures=True)
async def algorithm(known: Known, name: Name) -> View:
    """One implementation: equations, errors on reference features, field, ranks, an example."""
    about = next(i for i in known.catalogue.implementations(None) if i.name == name)
    places = boards.places_of(known, about.role, name)
    document = {**about.to_dict(), "ranks": places}
    columns = (*Algorithm.model_fields, *boards.COLUMNS)
    made: Any = (
        known.catalogue.extractors[name]
        if about.role == "extractor"
        else known.catalogue.models[name]
    )
    landing = landing_of_algorithm(name, identity())
    swept = _sweep(known, name) if about.role == "extractor" else []
    field = boards.field_chart(places)
    return View(
        "algorithm.html",
        Document(document, columns, lambda: [{**about.to_dict(), **place} for place in places]),
        landing=landing,
        entity=schema_org.algorithm(about, identity(), landing),
        about=about,
        stages=docstring_parts(made),
        places=places,
        figures=(*(chart for _, chart in swept), field),
        swept=swept,
        field=field,
        assessed=_assess(known, name),
        relatives=[
            i
            for i in known.catalogue.implementations(None)
            if i.taxonomy == about.taxonomy and i.role == about.role and i.name != name
        ],
    )


def _sweep(known: Knowledge, name: str) -> list[tuple[str, Figure]]:
    """Return a chart a sweep and series: the error on reference features with its bound."""
    charts = []
    for sweep, across in SWEPT:
        by: dict[str, list[Mapping[str, Any]]] = defaultdict(list)
        for row in known.measurements.sweeps:
            if row["extractor"] == name and row["sweep"] == sweep and row["value"] is not None:
                by[row["series"]].append(row)
        for series, rows in by.items():
            unit = rows[0]["unit"]
            chart = line_figure(
                re.sub(r"[^a-z0-9]+", "-", f"{sweep} {series}".lower()),
                f"Error of {name} against {across} on {series}, with its bound",
                [
                    Line("error", [(row["value"], row["rms"] or None) for row in rows]),
                    Line("bound", [(r["value"], r["bound"] or None) for r in rows], is_bound=True),
                ],
                across,
                f"RMS error, {unit}",
                log_across=sweep != "phase",
            )
            if chart.rows:
                charts.append((f"Against {across.split(',')[0]}: {series}", chart))
    return charts


def _assess(known: Knowledge, name: str) -> list[Mapping[str, Any]]:
    """Return what the survey says this method can do, beside what was measured."""
    return [
        {**verdict, "method": method["method"]}
        for method in known.measurements.assessment["methods"]
        if name in method["extractors"]
        for verdict in method["properties"]
    ]
