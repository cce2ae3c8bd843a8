"""The leaderboard as files: JSON, CSV and HTML of everything, and a page of the best in Markdown.

Only the page of the best is committed; the others are derived where they are wanted.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmark.leaderboard import summaries
from benchmark.leaderboard.architectures import architectures, first_boards
from benchmark.leaderboard.scope import BEHIND, CLOSE, UNITS, UNITS_BEHIND
from benchmark.results.csv_tables import format_cell, text_of
from files.atomic import replace_file
from files.csv_writing import escape_formulas
from registry.taxonomy import taxonomy_row

Board = Mapping[str, Any]
Row = Mapping[str, Any]

#: Name of the committed page.
PAGE = "leaderboard.md"

_TEMPLATES = Path(__file__).parent / "templates"
_SHARES = ("availability", "false_detection_rate")

#: Columns of the HTML tables; the JSON and CSV files have all.
SHOWN = {
    "rank": "#",
    "extractor": "Extractor",
    "model": "Model",
    "best_of_extractor": "Best of extractor",
    "studies": "Studies",
    "own_error_deg": "Own error (deg)",
    "units": "Units (deg)",
    "on_bench_deg": "On a bench (deg)",
    "rms_deg": "RMS, standard unit (deg)",
    "median_deg": "Median (deg)",
    "p997_deg": "99.7 % (deg)",
    "repeatability_deg": "Repeatability (deg)",
    "bound_deg": "Bound (deg)",
    "over_bound": "RMS / bound",
    "over_bound_se": "±",
    "bound_unit_deg": "Bound, unit unknown (deg)",
    "over_bound_unit": "RMS / that",
    "availability": "Answered",
    "false_detection_rate": "False Suns",
}
_BEST = (
    *(
        "best_of_extractor",
        "studies",
        "rank",
        "own_error_deg",
        "units",
        "on_bench_deg",
        "over_bound",
    ),
    *("repeatability_deg", *_SHARES),
)
#: Pipelines that are not the best of their extractor are on the page down to this rank.
_RANKS = 3

LEGEND = (
    "Own error: angle between the predicted and the true direction of the Sun, RMS, for a "
    "pipeline calibrated with true directions. It is the geometric mean over sensor units and "
    "includes the errors of false detections. Readings are corrected by the unit's dark and flat "
    "readings. On a bench: error expected with the standard calibration bench, the root sum of "
    "squares of own error and bench error. Bound: Cramer-Rao bound over the same samples for a "
    "known sensor unit, ± the standard error of the ratio; the second bound is for a unit known "
    "only through its dark and flat readings. Answered: share of the observable samples with an "
    "answer; false Suns: share of the other samples with an answer. Repeatability: standard "
    "deviation of the answers to a constant direction. Pipelines below 95 % availability rank "
    f"last. Under the first condition, pipelines with at most {CLOSE:g} times the error of the "
    f"first are scored on {UNITS} units, those with at most {BEHIND:g} times on {UNITS_BEHIND}; "
    "pipelines that a paired test over the units cannot separate share a rank, marked =. The best "
    "pipeline of each extractor comes first. Studies: number of mapped studies that used a "
    "pipeline on such a sensor, or that it represents if they do not state theirs."
)


def format_number(column: str, row: Row) -> str:
    """Spell a column of a row for people: four significant digits, a dash for none."""
    if column in _SPELT:
        return _SPELT[column](row)
    value = row[column]
    if value is None:
        return "-"
    if column in _SHARES:
        return f"{value:.3f}"
    return _digits(value) if isinstance(value, float) else str(value)


def _rank(row: Row) -> str:
    return "-" if row["rank"] is None else f"{row['rank']}{'=' if row['tied'] else ''}"


def _units(row: Row) -> str:
    if row["low_deg"] is None:
        return "-"
    return f"{_digits(row['low_deg'])} to {_digits(row['high_deg'])}"


_SPELT: Mapping[str, Callable[[Row], str]] = {
    "rank": _rank,
    "units": _units,
    "best_of_extractor": lambda row: "yes" if row["best_of_extractor"] else "-",
    "studies": lambda row: str(len(row["studies"]) or "-"),
}


def _digits(value: float) -> str:
    return f"{value:#.4g}".rstrip(".")


def page(board: Board) -> str:
    """Write the best of each architecture, and of each extractor on each data set, in Markdown."""
    names = [SHOWN[column] for column in _BEST]
    best = architectures(board)
    about = (
        "Of each data set's first condition the best pipeline of each extractor; behind them the "
        f"others of the first {_RANKS} ranks. All pipelines and conditions: `sunatlas leaderboard "
        "render --out DIRECTORY`, or the page and the API of `sunatlas serve`."
    )
    lines = [
        "# Leaderboard",
        "",
        LEGEND,
        "",
        "## By architecture",
        "",
        summaries.ARCHITECTURES,
        "",
        summaries.best_per_architecture_table(best),
        "",
        summaries.tally(best),
        "",
        "## By data set",
        "",
        about,
        "",
        f"| Data set | Pipeline | {' | '.join(names)} |",
        "| --- | --- |" + " ---: |" * len(names),
    ]
    for dataset, rows in first_boards(board):
        for row in rows:
            listed = row["rank"] is not None and not (row["twin_of"] or row["folded"])
            if listed and (row["best_of_extractor"] or row["rank"] <= _RANKS):
                texts = (format_number(column, row) for column in _BEST)
                pipeline = f"{row['extractor']} + {row['model']}"
                lines.append(f"| {dataset['name']} | {pipeline} | {' | '.join(texts)} |")
    return "\n".join(lines) + "\n"


def to_json(board: Board) -> str:
    """Write everything as JSON whose lists of objects have an item a line."""
    return _one_row_a_line(board) + "\n"


def _one_row_a_line(value: object) -> str:
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return "[\n" + ",\n".join(_one_row_a_line(item) for item in value) + "\n]"
    if isinstance(value, Mapping) and any(isinstance(item, list) for item in value.values()):
        fields = (f"{json.dumps(name)}: {_one_row_a_line(item)}" for name, item in value.items())
        return "{" + ", ".join(fields) + "}"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def to_csv(board: Board) -> str:
    """Write every row and column as CSV; lists joined by semicolons."""
    rows = [row for dataset in board["datasets"] for row in dataset["rows"]]
    leading = ("rank", "tied", "dataset", "condition", "extractor", "model")
    every = dict.fromkeys(column for row in rows for column in row)
    columns = [*leading, *(column for column in every if column not in leading)]
    joined = (
        {**row, "unit_rms_deg": _join(row), "studies": ";".join(row["studies"])} for row in rows
    )
    return text_of(columns, map(taxonomy_row, joined))


def _join(row: Row) -> str | None:
    errors = row["unit_rms_deg"]
    return None if errors is None else ";".join(format_cell(error) for error in errors)


def sweeps_csv(board: Board) -> str:
    """Write every row and column of the sweeps as CSV."""
    rows = board["sweeps"]
    columns = dict.fromkeys(("series", "sweep", "point", "extractor"))
    columns |= dict.fromkeys(column for row in rows for column in row)
    return text_of(list(columns), map(taxonomy_row, rows))


def to_html(board: Board, *, marked: Collection[tuple[str, str]] = (), note: str = "") -> str:
    """Write every table as a page that needs nothing beside itself.

    `marked` are extractor and model of pipelines whose rows are marked, `note` is a sentence below
    the legend.
    """
    import jinja2  # noqa: PLC0415 - only writing the page needs it

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_TEMPLATES),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    template = environment.get_template("leaderboard.html")
    return template.render(
        tables=list(_tables(board, marked)),
        note=note,
        headings=SHOWN,
        legend=LEGEND,
    )


def _tables(
    board: Board, marked: Collection[tuple[str, str]] = ()
) -> Iterator[tuple[Mapping[str, Any], list[dict[str, Any]]]]:
    """Give each dataset with its conditions; of each, rows of (column, text) that share its id."""
    for dataset in board["datasets"]:
        conditions = [
            {
                "name": condition,
                "rows": [
                    {
                        "cell": "/".join(
                            str(row[name])
                            for name in ("dataset", "condition", "extractor", "model")
                        ),
                        "reason": row["reason"],
                        "marked": (row["extractor"], row["model"]) in marked,
                        "behind": not row["best_of_extractor"],
                        "columns": [(column, format_number(column, row)) for column in SHOWN],
                    }
                    for row in rows
                ],
            }
            for condition, rows in groupby(dataset["rows"], key=lambda row: row["condition"])
        ]
        yield dataset, conditions


#: Files that can be derived, and how.
FORMATS: Mapping[str, Callable[[Board], str]] = {
    "leaderboard.json": to_json,
    "leaderboard.csv": to_csv,
    PAGE: page,
    "leaderboard.html": to_html,
    "sweeps.csv": sweeps_csv,
}


def render(board: Board, out: Path, *, for_spreadsheets: bool = False) -> list[Path]:
    """Write every derived file to a directory, each whole or not at all; returns their paths.

    `for_spreadsheets`: no spreadsheet shall run a cell of the CSV files.
    """
    paths = []
    for name, made in FORMATS.items():
        text = made(board)
        if for_spreadsheets and name.endswith(".csv"):
            text = escape_formulas(text)
        replace_file(out / name, text)
        paths.append(out / name)
    return paths
