"""Publications per year, by kind of publication, and per venue, by period."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from api.figures import svg, wording
from api.figures.addresses import Addresses
from api.figures.bars import Bar, Part, horizontal_bars, upright_bars
from api.figures.figure import Entry, Figure
from api.figures.legend import legend
from api.figures.lettering import line_height
from api.figures.svg import BODY, SMALL, Drawing
from api.schema.figures import PublicationRow
from api.schema.table import columns_of
from registry.flows import Where, flows
from registry.studies import Facts, Study

NAME = "publications"
TITLE = "Publications per year and venue"
CAPTION = "When and where the mapped studies were published."

KINDS = {
    "journal": "c1",
    "conference": "c2",
    "preprint": "c3",
    "thesis": "c4",
    "report": "c5",
    "unknown": "c0",
}
"""Kind of publication -> colour."""
_KIND_NAMES = {"unknown": "kind not known"}
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
    rows: list[dict[str, Any]] = []
    years = _years(dated, addresses, rows)
    periods = _periods(dated)
    venues, others = _venue_bars(dated, periods, addresses, rows)
    kinds = [kind for kind in KINDS if any(_kinds().get(s.key, "unknown") == kind for s in dated)]
    by_kind = [Entry(KINDS[kind], _KIND_NAMES.get(kind, kind)) for kind in kinds]
    by_period = [
        Entry(colour, f"{a}–{b}" if a < b else f"{a}") for (a, b), colour in periods.items()
    ]

    def draw(width: float) -> Drawing:
        return _draw(years, by_kind, venues, by_period, others, width=width)

    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(dated, years, rows),
        studies=len(studies),
        left_out=(),
        columns=columns_of(PublicationRow),
        rows=tuple(rows),
        draw=draw,
    )


def _years(studies: Sequence[Study], addresses: Addresses, rows: list[dict[str, Any]]) -> list[Bar]:
    """Return a bar for every year from the first to the last, those without a study too."""
    found = [study.year for study in studies if study.year is not None]
    bars = []
    for year in range(min(found, default=0), max(found, default=-1) + 1):
        parts = []
        for kind, colour in KINDS.items():
            keys = [
                study.key
                for study in studies
                if study.year == year and _kinds().get(study.key, "unknown") == kind
            ]
            if keys:
                title = f"{year}, {_KIND_NAMES.get(kind, kind)}: {wording.studies(len(keys))}"
                href = addresses.of(keys, {}, len(rows), (year, year))
                parts.append(Part(len(keys), colour, title, href))
                rows.append(_row("year", str(year), kind, keys))
        bars.append(Bar(str(year), f"’{year % 100:02}", tuple(parts)))
    return bars


def _periods(studies: Sequence[Study]) -> dict[tuple[int, int], str]:
    """Return periods of years with their colours, the first from the first year on."""
    years = [study.year for study in studies if study.year is not None]
    first, last = min(years, default=0), max(years, default=-1)
    starts = range(first, last + 1, PERIOD)
    return {
        (start, min(start + PERIOD - 1, last)): f"c{3 + at % 6}" for at, start in enumerate(starts)
    }


def _venue_bars(
    studies: Sequence[Study],
    periods: Mapping[tuple[int, int], str],
    addresses: Addresses,
    rows: list[dict[str, Any]],
) -> tuple[list[Bar], list[Part]]:
    """Return a bar for each venue with several studies, and what is said of all other studies."""
    of: dict[str, list[Study]] = {}
    for study in studies:
        of.setdefault(_venues().get(study.key, ""), []).append(study)
    unknown = of.pop("", [])
    several = sorted((v for v in of if len(of[v]) > 1), key=lambda v: (-len(of[v]), v))
    single = sorted(v for v in of if len(of[v]) == 1)
    bars = [_stack(venue, of[venue], periods, addresses=addresses, rows=rows) for venue in several]
    others = []
    if single:
        label = wording.plural(len(single), "venue has one study", "venues have one study each")
        others.append(Part(len(single), "", label, f"{addresses.page}#row-{len(rows)}"))
        for venue in single:
            _stack(venue, of[venue], periods, addresses=addresses, rows=rows)
    if unknown:
        label = f"The venue of {wording.plural(len(unknown), 'study', 'studies')} is not known"
        others.append(Part(len(unknown), "", label, f"{addresses.page}#row-{len(rows)}"))
        _stack("", unknown, periods, addresses=addresses, rows=rows)
    return bars, others


def _stack(
    venue: str,
    studies: Sequence[Study],
    periods: Mapping[tuple[int, int], str],
    *,
    addresses: Addresses,
    rows: list[dict[str, Any]],
) -> Bar:
    """Return the bar of a venue, and append a row a period."""
    parts = []
    for (first, last), colour in periods.items():
        keys = [s.key for s in studies if s.year is not None and first <= s.year <= last]
        if keys:
            title = f"{venue}, {first}–{last}: {wording.studies(len(keys))}"
            parts.append(Part(len(keys), colour, title, addresses.of(keys, {}, len(rows))))
            rows.append(_row("venue", venue, f"{first}–{last}", keys))
    return Bar(venue, venue, tuple(parts))


def _row(part: str, value: str, stack: str, keys: Sequence[str]) -> dict[str, Any]:
    return {
        "part": part,
        "value": value,
        "stack": stack,
        "count": len(keys),
        "studies": list(keys),
    }


def _draw(
    years: Sequence[Bar],
    by_kind: Sequence[Entry],
    venues: Sequence[Bar],
    by_period: Sequence[Entry],
    others: Sequence[Part],
    *,
    width: float,
) -> Drawing:
    """Return both charts, one above the other, each with its heading and its legend."""
    if not years:
        return Drawing(width, 40, svg.text(0, 20, "No study meets the filters.", "quiet"))
    size = BODY if width > 900 else SMALL
    shapes = [svg.text(0, 12, "Studies per year", "heading", size=size, bold=True)]
    drawn, y = legend(by_kind, 26, width)
    shapes.append(drawn)
    drawn, y = upright_bars(years, y + 8, width) or horizontal_bars(years, y + 8, width)
    shapes.append(drawn)
    y += 34
    shapes.append(svg.text(0, y, "Studies per venue", "heading", size=size, bold=True))
    drawn, y = legend(by_period, y + 14, width)
    shapes.append(drawn)
    drawn, y = horizontal_bars(venues, y + 8, width)
    shapes.append(drawn)
    for said in others:
        lines = svg.fit(said.title, width, size)
        half = len(lines) * line_height(size) / 2
        written = svg.text(0, y + half + 4, lines, "quiet", size=size)
        shapes.append(svg.mark(said.title, said.href, written))
        y += 2 * half + 2
    return Drawing(width, y + 8, "".join(shapes))


def _text(
    studies: Sequence[Study], years: Sequence[Bar], rows: Sequence[Mapping[str, Any]]
) -> tuple[str, ...]:
    if not studies:
        return ("No study meets the filters.",)
    most = sorted(years, key=lambda bar: -bar.count)[:2]
    said = [
        f"{wording.studies(len(studies))}, {years[0].label} to {years[-1].label}.",
        "Most in "
        + wording.join_words([f"{bar.label} ({bar.count})" for bar in most if bar.count])
        + ".",
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
            f"({venues[first]})."
        )
    return tuple(said)
