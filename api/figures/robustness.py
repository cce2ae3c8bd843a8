"""Robustness: multiples of the bound by condition, or two methods on every board that has both."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

from api.addresses import algorithm_page, dataset_page
from api.figures.figure import Figure, Row
from api.figures.specification import (
    AXIS,
    HOVER,
    LINE,
    Plotly,
    axis,
    colour,
    mark,
    scale,
    specification,
)
from api.schema.measured_figures import RobustnessRow
from api.schema.table import columns_of
from benchmark.leaderboard.summaries import digits

NAME = "robustness"
TITLE = "Robustness by condition"
WORST = "worst"
"""The column of the worst of the conditions that are asked for."""
_NEAR = 2.0  # times the bound
_MOST_NAMED = 6  # data sets in a sentence
_FIRST = 3  # rows in a sentence
_MANY = 10  # data sets of a condition that is drawn unasked
_LARGEST = 4  # power of ten of the darkest shade


def robustness_figure(
    items: Sequence[dict[str, Any]],
    *,
    rows: str,
    asked: Sequence[str],
    datasets: Sequence[str] = (),
    best: Sequence[Row] = (),
    together: Sequence[str] = (),
    pairwise: Sequence[Row] = (),
    duels: Sequence[Row] = (),
) -> Figure:
    """Return the figure: cells of the table, or the duels where two are compared.

    Parameters
    ----------
    items : cells
    rows : extractor or model
    asked : hazards and conditions that are asked for
    datasets, best : those that have all of them, and the best row on each
    together : conditions in which all of them act at once
    pairwise, duels : of two that are compared; empty where none are
    """
    caption = (
        f"RMS error of each {rows} as a multiple of the Cramer-Rao bound (unit 0, known), median "
        "over data sets, by its best pipeline under the first condition. A cross: availability "
        "below 95 % on half of the data sets or more. Grey: not tested; k: thousand. Unless "
        f"conditions are asked for, those of {_MANY} data sets or more are drawn; the table has "
        "all."
    )
    if pairwise:
        caption = (
            f"Error of {pairwise[0]['first']} over that of {pairwise[0]['second']} on every data "
            "set and condition that has both; a mark a condition. Not drawn: boards on which only "
            "one has 95 % availability."
        )
    text = [*(_pairwise_text(pairwise) if pairwise else _text(items, rows, asked, datasets, best))]
    if together and not pairwise:
        text.append(f"All of them act at once under {' and '.join(together)}.")
    return Figure(
        name=NAME,
        title=TITLE,
        caption=caption,
        text=tuple(text),
        columns=columns_of(RobustnessRow),
        rows=tuple(items),
        plotly=_duels(duels, pairwise[0]) if pairwise else _heat(items, asked=bool(asked)),
        options={"rows": rows, "asked": ", ".join(asked)},
    )


def grid(items: Sequence[Row]) -> tuple[list[str], list[list[Row]]]:
    """Return the conditions, and the cells of each row in their order."""
    conditions = list(dict.fromkeys(row["condition"] for row in items))
    of: dict[str, list[Row]] = {}
    for row in items:
        of.setdefault(row["name"], []).append(row)
    return conditions, list(of.values())


def _heat(items: Sequence[Row], *, asked: bool) -> Plotly:
    """Return cells in shades of their power of ten, over grey ones for what was not measured."""
    conditions, cells = grid(items if asked else _common(items))
    shared = {
        "type": "heatmap",
        "x": conditions,
        "y": [of[0]["name"] for of in cells],
        "customdata": [
            [mark(_said(row), algorithm_page(row["name"])) for row in of] for of in cells
        ],
        "hovertemplate": HOVER,
        "texttemplate": "%{text}",
        "hoverongaps": False,
        "showscale": False,
        "xgap": 1,
        "ygap": 1,
    }
    crossed = [["×" if row["state"] == "below 95 %" else "" for row in of] for of in cells]
    missing = [[0 if row["over_bound"] is None else None for row in of] for of in cells]
    log = [[row["over_bound"] and math.log10(row["over_bound"]) for row in of] for of in cells]
    said = [[_short(row["over_bound"]) for row in of] for of in cells]
    grey = {"z": missing, "text": crossed, "colorscale": scale((LINE, LINE)), "zmin": 0, "zmax": 1}
    shaded = {"z": log, "text": said, "colorscale": scale(), "zmin": 0, "zmax": _LARGEST}
    return specification(
        [{**shared, **grey}, {**shared, **shaded}],
        height=150 + 22 * len(cells),
        narrowest=200 + 34 * len(conditions),
        xaxis=axis(side="top", tickangle=-50, type="category", showgrid=False),
        yaxis=axis(autorange="reversed", type="category", showgrid=False),
    )


def _common(items: Sequence[Row]) -> list[Row]:
    """Return the cells of conditions that many data sets have."""
    of: dict[str, set[str]] = {}
    for row in items:
        of.setdefault(row["condition"], set()).update(row["datasets"])
    most = max(map(len, of.values()), default=0)
    return [row for row in items if len(of[row["condition"]]) >= min(_MANY, most)]


def _short(value: float | None) -> str:
    """Return a multiple in two digits, as it fits a cell."""
    if value is None:
        return ""
    return digits(value, 2) if value < 1000 else f"{float(f'{value:.1g}') / 1000:g}k"


def _said(row: Row) -> str:
    place = f"{row['name']}, {row['condition']}"
    if row["state"] == "untested":
        return f"{place}: not tested"
    on = f"data sets: {row['data_sets']}"
    if row["over_bound"] is None:
        return f"{place}: availability below 95 %, {on}"
    return f"{place}: {digits(row['over_bound'])} times the bound, {on}"


def _duels(duels: Sequence[Row], pair: Row) -> Plotly:
    shown = [row for row in duels if row["ratio"]]
    datasets = sorted({row["dataset"] for row in shown})
    marks = {
        "type": "scatter",
        "mode": "markers",
        "x": [row["ratio"] for row in shown],
        "y": [row["dataset"] for row in shown],
        "customdata": [
            mark(
                f"{row['dataset']}, {row['condition']}: {digits(row['ratio'])} ({row['outcome']})",
                dataset_page(row["dataset"]),
            )
            for row in shown
        ],
        "hovertemplate": HOVER,
        "marker": {"symbol": "circle-open", "size": 9, "color": colour(0)},
    }
    equal = {
        "type": "scatter",
        "mode": "lines",
        "x": [1.0] * len(datasets),
        "y": datasets,
        "hoverinfo": "skip",
        "line": {"dash": "dot", "width": 1.2, "color": AXIS},
    }
    return specification(
        [equal, marks],
        height=110 + 36 * len(datasets),
        narrowest=560,
        showlegend=False,
        xaxis=axis(
            f"Error of {pair['first']} / error of {pair['second']}",
            type="log",
            dtick=1,
            exponentformat="none",
        ),
        yaxis=axis(type="category", autorange="reversed"),
    )


def _text(
    items: Sequence[Row],
    rows: str,
    asked: Sequence[str],
    datasets: Sequence[str],
    best: Sequence[Row],
) -> Iterator[str]:
    names = {row["name"] for row in items}
    if not asked:
        first = [row for row in items if row["condition"] == "nominal"]
        near = sum((row["over_bound"] or math.inf) <= _NEAR for row in first)
        yield (
            f"Under nominal conditions {near} of {len(names)} {rows}s are within {_NEAR:g} times "
            "the bound in the median."
        )
        yield "Rows are tested on different data sets; asked conditions compare like with like."
        return
    both = " and ".join(asked)
    if not datasets:
        yield f"No data set has {both}; columns show each by itself."
        return
    if best and len(best) <= _MOST_NAMED:
        named = (
            f"{row['name']} on {row['dataset']} ({digits(row['over_bound'])} times the bound)"
            for row in best
        )
        yield f"Smallest error under the worst of {both}: {', '.join(named)}."
    worst = [row for row in items if row["condition"] == WORST]
    yield from _best(worst, rows, len(datasets))


def _best(worst: Sequence[Row], rows: str, datasets: int) -> Iterator[str]:
    """Say which rows err least under the worst of what is asked, and how good that is."""
    known = [row for row in worst if row["over_bound"] is not None]
    if not known:
        yield f"No {rows} has 95 % availability there."
        return
    listed = "; ".join(
        f"{row['name']} ({digits(row['over_best'])} times the best of each, "
        f"{digits(row['over_bound'])} times the bound, on {row['data_sets']})"
        for row in known[:_FIRST]
    )
    yield f"One {rows} for all data sets that have them ({datasets}), in the median: {listed}."
    near = sum(row["over_bound"] <= _NEAR for row in known)
    yield f"Of {len(worst)}, {near} are within {_NEAR:g} times the bound under the worst of them."


def _pairwise_text(pairwise: Sequence[Row]) -> Iterator[str]:
    for row in pairwise:
        first, second, decided = row["first"], row["second"], row["wins"] + row["losses"]
        boards = decided + row["ties"] + row["neither"]
        share = ""
        if decided:
            share = (
                f" ({100 * row['wins'] / decided:.0f} % of the decided, 95 % interval "
                f"{100 * row['share_low']:.0f} to {100 * row['share_high']:.0f} % as if boards "
                "were independent)"
            )
        if row["ratio"] is not None:
            low, high = row["ratio_low"] or 0.0, row["ratio_high"] or math.inf
            settled = low > 1.0 or high < 1.0
            better = f"{second if low > 1.0 else first} is better"
            yield (
                f"{row['scope'].capitalize()}: {better if settled else 'neither is shown better'}. "
                f"The error of {first} is {digits(row['ratio'], 2)} times that of {second} in the "
                f"median; 95 % interval over {row['data_sets']} data sets: {digits(low, 2)} to "
                f"{digits(row['ratio_high'], 2, 'no limit')}."
            )
        yield (
            f"{row['scope'].capitalize()}, {boards} boards of {row['data_sets']} data sets: "
            f"{first} has the smaller error on {row['wins']}{share}, {second} on {row['losses']}; "
            f"equal within 3 % on {row['ties']}; on {row['neither']} neither has 95 % availability."
        )
