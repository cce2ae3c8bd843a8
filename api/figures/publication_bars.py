"""Publications per year, by kind of publication, and per venue, by period."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure
from api.figures.specification import (
    HOVER,
    UNKNOWN,
    Plotly,
    axis,
    colour,
    legend,
    mark,
    specification,
)
from api.schema.figures import PublicationRow
from api.schema.table import columns_of
from registry.flows import Where, flows
from registry.studies import Facts, Study

NAME = "publications"
TITLE = "Publications per year and venue"
CAPTION = "When and where the mapped studies were published."

KINDS = ("journal", "conference", "preprint", "thesis", "report", "unknown")
_KIND_NAMES = {"unknown": "kind not known"}
_FIRST_PERIOD = 2  # the place of its colour
_YEARS, _BAR = 260, 24  # px: height of the years' chart, and of a venue
PERIOD = 5  # years


@cache
def _kinds() -> Mapping[str, str]:
    """Return the kind of publication of each study."""
    studies = _tables().edition("all").studies
    return dict(zip(studies["key"], studies["type"], strict=True))


@cache
def _venues() -> Mapping[str, str]:
    """Return the venue of each study whose venue is known.

    Of a study that the survey does not map, the venue is what stands before its first comma or
    colon, so that volumes of a journal and numbers of a repository count together.
    """
    tables = _tables()
    found = dict(zip(tables.venues["study"], tables.venues["venue"], strict=True))
    later = tables.extension_studies.dropna(subset=["venue"])
    for key, venue in zip(later["key"], later["venue"], strict=True):
        found[key] = re.split(r"[,:]", venue)[0].strip()
    return found


@cache
def _tables() -> Any:
    from survey_data import load  # noqa: PLC0415 - slow, and not needed to make the service

    return load()


def publications_figure(facts: Facts, addresses: Addresses, where: Where) -> Figure:
    """Return the publications of the studies that meet `where`."""
    keys = flows(("detector", "mask"), where, facts=facts).studies
    studies = [facts.studies[key] for key in keys]
    dated = [study for study in studies if study.year is not None]
    rows = _years(dated)
    periods = _periods(dated)
    venues = _venues_of(dated)
    several = [name for name, of in venues.items() if name and len(of) > 1]
    singles = sorted(name for name, of in venues.items() if name and len(of) == 1)
    for name in (*several, *singles, *[""] * ("" in venues)):
        rows += _stack(name, venues[name], periods)
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(dated, rows),
        columns=columns_of(PublicationRow),
        rows=tuple(rows),
        plotly=_plotly(rows, several, periods, addresses),
        studies=len(studies),
    )


def _years(studies: Sequence[Study]) -> list[dict[str, Any]]:
    """Return a row for every year and kind of publication."""
    rows = []
    for year in sorted({study.year for study in studies if study.year is not None}):
        for kind in KINDS:
            keys = [
                study.key
                for study in studies
                if study.year == year and _kinds().get(study.key, "unknown") == kind
            ]
            if keys:
                rows.append(_row("year", str(year), kind, keys))
    return rows


def _periods(studies: Sequence[Study]) -> list[tuple[int, int]]:
    """Return periods of years, the first from the first year on."""
    years = [study.year for study in studies if study.year is not None]
    first, last = min(years, default=0), max(years, default=-1)
    starts = range(first, last + 1, PERIOD)
    return [(start, min(start + PERIOD - 1, last)) for start in starts]


def _venues_of(studies: Sequence[Study]) -> dict[str, list[Study]]:
    """Return venues with their studies, the fullest first; "" is not known."""
    of: dict[str, list[Study]] = {}
    for study in studies:
        of.setdefault(_venues().get(study.key, ""), []).append(study)
    return {name: of[name] for name in sorted(of, key=lambda name: (-len(of[name]), name))}


def _stack(
    venue: str, studies: Sequence[Study], periods: Sequence[tuple[int, int]]
) -> list[dict[str, Any]]:
    """Return a row for each period of a venue."""
    rows = []
    for first, last in periods:
        keys = [s.key for s in studies if s.year is not None and first <= s.year <= last]
        if keys:
            rows.append(_row("venue", venue, _said(first, last), keys))
    return rows


def _said(first: int, last: int) -> str:
    return f"{first}–{last}"


def _row(part: str, value: str, stack: str, keys: Sequence[str]) -> dict[str, Any]:
    return {"part": part, "value": value, "stack": stack, "count": len(keys), "studies": list(keys)}


def _plotly(
    rows: Sequence[Mapping[str, Any]],
    venues: Sequence[str],
    periods: Sequence[tuple[int, int]],
    addresses: Addresses,
) -> Plotly:
    """Return upright bars of years by kind above lying ones of venues by period."""
    stacks = {("year", kind): colour(at) for at, kind in enumerate(KINDS[:-1])}
    stacks["year", "unknown"] = UNKNOWN
    for at, period in enumerate(periods):
        stacks["venue", _said(*period)] = colour(_FIRST_PERIOD + at)
    data = []
    for (part, stack), tone in stacks.items():
        mine = [
            (at, row)
            for at, row in enumerate(rows)
            if (row["part"], row["stack"]) == (part, stack)
            and (part == "year" or row["value"] in venues)
        ]
        name = _KIND_NAMES.get(stack, stack)
        marks = []
        for at, row in mine:
            years = (int(row["value"]),) * 2 if part == "year" else None
            href = addresses.of(row["studies"], {}, at, years)
            said = f"{row['value']}, {name}: {wording.studies(row['count'])}"
            marks.append(mark(said, href))
        counts = [row["count"] for _, row in mine]
        values = [int(row["value"]) if part == "year" else row["value"] for _, row in mine]
        shared = {
            "type": "bar",
            "name": name,
            "marker": {"color": tone},
            "customdata": marks,
            "hovertemplate": HOVER,
        }
        if not mine:
            continue
        if part == "year":
            data.append({**shared, "x": values, "y": counts})
        else:
            axes = {"xaxis": "x2", "yaxis": "y2", "legend": "legend2"}
            data.append({**shared, **axes, "orientation": "h", "y": values, "x": counts})
    lower = _BAR * len(venues)
    height = _YEARS + lower + 110
    return specification(
        data,
        height=height,
        narrowest=640,
        barmode="stack",
        xaxis=axis(anchor="y", showgrid=False),
        yaxis=axis("Studies per year", domain=[1 - _YEARS / height, 1]),
        xaxis2=axis("Studies per venue", anchor="y2"),
        yaxis2=axis(
            anchor="x2",
            domain=[0, lower / height],
            categoryarray=list(venues),
            categoryorder="array",
            autorange="reversed",
            showgrid=False,
        ),
        legend2=legend(lower / height),
    )


def _text(studies: Sequence[Study], rows: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    if not studies:
        return ("No study meets the filters.",)
    years = Counter(sorted(study.year for study in studies if study.year is not None))
    most = [f"{year} ({count})" for year, count in years.most_common(2)]
    said = [
        f"{wording.studies(len(studies))}, {min(years)} to {max(years)}.",
        f"Most in {wording.join_words(most)}.",
    ]
    venues: dict[str, int] = {}
    for row in rows:
        if row["part"] == "venue" and row["value"]:
            venues[row["value"]] = venues.get(row["value"], 0) + row["count"]
    if venues:
        first = max(venues, key=lambda venue: venues[venue])
        known = sum(venues.values())
        said.append(
            f"The venue of {known} is known, one of {len(venues)}; most are in {first} "
            f"({venues[first]}). Those with one study are in the table alone."
        )
    return tuple(said)
