"""/claims and /claims/{id}: statements of the survey about algorithms, each with its test."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import Path, Query

from api.figures.figure import Figure
from api.figures.lines import Line, line_figure
from api.pages.serving import PageRouter, View
from api.schema.claims import ClaimsQuery
from api.schema.words import ClaimId
from api.service import claims as service
from api.web.dependencies import Known
from benchmark.claims.ledger import tally

router = PageRouter()

EVERY = 500
VERDICTS = {
    "reproduced": "Every criterion holds.",
    "partly": "Some criteria hold, others do not.",
    "not reproduced here": "No criterion holds, and the trial is not wholly the sentence's case.",
    "refuted": "No criterion holds, and the trial is the sentence's own case.",
    "not testable": "The trials cannot decide.",
    "not measured": "Not measured yet.",
}
RESULTS = {
    "holds": "holds",
    "fails": "fails",
    "open": "undecided: the interval includes the threshold",
}


@router.page("/claims")
async def claims(known: Known, query: Annotated[ClaimsQuery, Query()]) -> View:
    """List the claims with their verdicts and the number of each verdict."""
    answer = service.claims(known, query.model_copy(update={"limit": EVERY}))
    every = tally(known.measurements.claims.values())
    changed = sum(bool(entry.former) for entry in known.measurements.claims.values())
    return View("claims.html", answer, asked=query, verdicts=VERDICTS, every=every, changed=changed)


@router.page("/claims/{id}", figures=True)
async def claim(known: Known, id: Annotated[ClaimId, Path()]) -> View:  # noqa: A002 - as the service
    """Show a claim: statement, criteria, results and plot."""
    answer = service.claim(known, id)
    entries = known.measurements.claims
    ids = list(entries)
    at = ids.index(id)
    said = answer.document["study"]
    text = " ".join(str(answer.document[name]) for name in ("measured_on", "statement"))
    chart = _chart(answer.document)
    return View(
        "claim.html",
        answer,
        figures=(chart,),
        chart=chart,
        verdicts=VERDICTS,
        results=RESULTS,
        studies=[key for key in known.facts.studies if key in said],
        datasets=[name for name in known.measurements.presets if _names(text, name)],
        algorithms=[i.name for i in known.catalogue.implementations(None) if _names(text, i.name)],
        before=ids[at - 1] if at else None,
        after=ids[at + 1] if at + 1 < len(ids) else None,
        entry=entries[id],
    )


def _names(text: str, name: str) -> bool:
    """Say whether a text names something: as a word of its own, not as part of a longer name."""
    cleaned = "".join(c if c.isalnum() or c == "-" else " " for c in text)
    return f" {name} " in f" {cleaned} "


def _chart(document: Mapping[str, Any]) -> Figure:
    lines = [
        Line(
            name,
            list(zip(line["x"], line["median"], strict=True)),
            list(zip(line["x"], line["low"], line["high"], strict=True)),
        )
        for name, line in document["lines"].items()
    ]
    across = document["x_label"] or ""
    # What stands across may be words, such as conditions: those are shown as a table.
    drawn = [
        line
        for line in lines
        if len(line.points) > 1 and all(isinstance(x, int | float) for x, _ in line.points)
    ]
    spread = [x for line in drawn for x, _ in line.points]
    wide = bool(spread) and min(spread) > 0 and max(spread) / min(spread) > 20
    return line_figure(
        "trials",
        f"Measurements for claim {document['id']}",
        drawn,
        across,
        document["y_label"] or "",
        log_across=wide,
    )
