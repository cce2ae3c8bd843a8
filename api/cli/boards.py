"""Leaderboard summary as text: architectures on a screen of 80 columns, and parts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from api.cli.table_output import prose, table
from benchmark.leaderboard.overview import ROLES, WITHIN, suffix
from benchmark.leaderboard.summaries import digits, tally
from benchmark.metrics.score import AVAILABLE

Row = Mapping[str, Any]

WIDTH = 80
_HEADINGS = ("architecture", "best pipeline", "flight", "own", "", "bounds", "bench")
_NUMBERS = frozenset({"flight", "own", "bounds", "bench", "median", *map("{:g}".format, WITHIN)})
_MORE = "More: --dataset NAME, --each (every data set), --overview, --format json."
_ARCHITECTURE = (17, 32)  # columns of names; numbers take the rest


def architectures_text(rows: Sequence[Row], width: int = WIDTH) -> str:
    """Return the best pipeline of each architecture, in lines of 80 characters one each."""
    room = min(width, WIDTH)
    lines = [
        *prose(
            "The best pipeline of each architecture under nominal conditions, by own error. Errors "
            "in deg: flight, calibrated on the ground once and flown; own; bench, calibrated on "
            "the standard bench. bounds: RMS of unit 0 over the Cramer-Rao bound, the unit known. "
            "=: tie with the runner-up. "
            f"{tally(rows)}",
            room,
        ),
        "",
    ]
    cells = [_architecture(row) for row in rows]
    if width < WIDTH:
        named = [dict(zip(_HEADINGS, row, strict=True)) for row in cells]
        lines.append(table(named, _HEADINGS, width, right=_NUMBERS))
    else:
        lines.append(_line(*_HEADINGS))
        for row in cells:
            lines += _line_of(row)
    lines.append("")
    for words in (_several(rows), _seldom(rows), _finer(rows), _MORE):
        lines += prose(words, room)
    return "\n".join(lines) + "\n"


def overview_text(document: Mapping[str, Any], width: int = WIDTH) -> str:
    """Return how near the bound each part of a pipeline comes as lines."""
    lines = prose(document["says"], width)
    for role in ROLES:
        parts = [_part(part) for part in document["parts"] if part["role"] == role]
        if parts:
            lines += ["", table(parts, tuple(parts[0]), width, right=_NUMBERS)]
    return "\n".join(lines) + "\n"


def _architecture(row: Row) -> tuple[str, ...]:
    """Return the cells of an architecture, in the order of `_HEADINGS`."""
    name = f"{row['detector']} {row['mask']}"
    if row["extractor"] is None:
        return (name, "none has an error", "-", "-", "", "-", "-")
    pipeline = f"{row['extractor']} + {row['model']}"
    return (
        name,
        pipeline,
        digits(row["flight_error_deg"]),
        digits(row["own_error_deg"]),
        "=" if row["tie"] else "",
        _ratio(row["over_bound"]),
        digits(row["on_bench_deg"]),
    )


def _line_of(cells: Sequence[str]) -> Iterator[str]:
    name, pipeline, *numbers = cells
    if len(name) >= _ARCHITECTURE[0] or len(pipeline) > _ARCHITECTURE[1]:
        # A name is never cut; one that is too long has a line of its own.
        yield from prose(f"{name} {pipeline}", WIDTH)
        name, pipeline = "", ""
    yield _line(name, pipeline, *numbers)


def _line(*cells: str) -> str:
    name, pipeline, flight, own, tie, ratio, bench = cells
    wide, wider = _ARCHITECTURE
    numbers = f"{flight:>7} {own:>8}{tie:1} {ratio:>6} {bench:>6}"
    return f"{name:<{wide}}{pipeline:<{wider}}{numbers}".rstrip()


def _ratio(value: float | None) -> str:
    if value is None:
        return "-"
    return digits(value) if value < 1e5 else f"{value:.0e}".replace("+0", "")


def _several(rows: Sequence[Row]) -> str:
    """Name the data set shown where there are several."""
    named = [f"{row['dataset']} {len(row['datasets'])}" for row in rows if len(row["datasets"]) > 1]
    return (
        f"Architectures with several data sets, the one shown and their number: {', '.join(named)}."
        if named
        else ""
    )


def _seldom(rows: Sequence[Row]) -> str:
    """Name pipelines below 95 % availability, shown where no other has an error."""
    named = [
        f"{row['detector']} {row['mask']} {100 * row['availability']:.0f} %"
        for row in rows
        if row["availability"] is not None and row["availability"] < AVAILABLE
    ]
    return f"Below 95 % availability: {'; '.join(named)}." if named else ""


def _finer(rows: Sequence[Row]) -> str:
    """Name pipelines with a lower error at lower availability."""
    named = [
        f"{row['detector']} {row['mask']} {digits(row['partial_own_error_deg'])} deg "
        f"({row['partial_extractor']} + {row['partial_model']}, "
        f"{100 * row['partial_availability']:.0f} %)"
        for row in rows
        if row["partial_extractor"] is not None
    ]
    return f"Lower error at lower availability: {'; '.join(named)}." if named else ""


def _part(part: Row) -> dict[str, str | int]:
    shares = {f"{limit:g}": f"{100 * part[f'share_{suffix(limit)}']:.0f} %" for limit in WITHIN}
    return {
        part["role"]: part["part"],
        "boards": part["boards"],
        **shares,
        "median": _ratio(part["median_over_bound"]),
        "leads": part["leads"],
        "reach": part["reachable_10"],
    }
