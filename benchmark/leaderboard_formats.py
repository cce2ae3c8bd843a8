"""The leaderboard as JSON, CSV, Markdown and HTML: how each is written, and read back cell by cell.

Reading back serves `benchmark.leaderboard_check`: a changed number is named by its cell.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from html.parser import HTMLParser
from itertools import groupby
from pathlib import Path
from typing import Any

from benchmark import sweep_tables

Board = Mapping[str, Any]
#: Text of each cell by ("dataset/condition/extractor/model", column).
Cells = dict[tuple[str, str], str]

_TEMPLATES = Path(__file__).parent / "templates"

IDENTITY = ("dataset", "condition", "extractor", "model")

#: Columns of the Markdown and HTML tables; the JSON and CSV files have all.
SHOWN = {
    "rank": "#",
    "extractor": "Extractor",
    "model": "Model",
    "rms_deg": "RMS (deg)",
    "median_deg": "Median (deg)",
    "p95_deg": "95 % (deg)",
    "max_deg": "Max (deg)",
    "bound_deg": "Bound (deg)",
    "over_bound": "RMS / bound",
    "over_bound_se": "±",
    "found_fraction": "Found",
    "time_ratio": "Time ratio",
}

LEGEND = (
    "Error is the angle between the predicted and the true direction of the Sun, over the found "
    "samples of the test split. Bound is the Cramer-Rao lower bound of that angle (root mean "
    "square), ± the standard error of the ratio to it; both are over samples that are found and "
    "whose direction is observable at all. Found is the share of samples with an answer. Time "
    "ratio is extraction and prediction over a weighted sum of the same observations in NumPy, "
    "measured side by side; it depends on the machine and is not part of any check."
)


@dataclass(frozen=True)
class Format:
    """One file of the leaderboard."""

    render: Callable[[Board], str]
    read: Callable[[str], Cells]


def shown(column: str, value: object) -> str:
    """Spell a value for people: four significant digits, a dash for none."""
    if value is None:
        return "-"
    if isinstance(value, float):
        if column == "found_fraction":
            return f"{value:.4f}"
        return f"{value:#.4g}".rstrip(".")
    return str(value)


def _to_json(board: Board) -> str:
    return _one_row_a_line(board) + "\n"


def _one_row_a_line(value: object) -> str:
    """JSON whose lists of objects have an item a line: to be compared line by line."""
    if isinstance(value, list) and value and isinstance(value[0], Mapping):
        return "[\n" + ",\n".join(_one_row_a_line(item) for item in value) + "\n]"
    if isinstance(value, Mapping) and any(isinstance(item, list) for item in value.values()):
        fields = (f"{json.dumps(name)}: {_one_row_a_line(item)}" for name, item in value.items())
        return "{" + ", ".join(fields) + "}"
    return json.dumps(value, ensure_ascii=False, allow_nan=False)


def _from_json(text: str) -> Cells:
    board = json.loads(text)
    return {
        (_cell(row), column): _plain(value)
        for dataset in board["datasets"]
        for row in dataset["rows"]
        for column, value in row.items()
    } | sweep_tables.cells(board["sweeps"])


def _to_csv(board: Board) -> str:
    rows = [row for dataset in board["datasets"] for row in dataset["rows"]]
    leading = ("rank", *IDENTITY)
    every = dict.fromkeys(column for row in rows for column in row)
    columns = [*leading, *(column for column in every if column not in leading)]
    stream = io.StringIO(newline="")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_plain(row.get(column)) for column in columns] for row in rows)
    return stream.getvalue()


def _from_csv(text: str) -> Cells:
    return {
        (_cell(row), column): value or ""
        for row in csv.DictReader(io.StringIO(text, newline=""))
        for column, value in row.items()
        if column is not None
    }


def _tables(board: Board) -> Iterator[tuple[Mapping[str, Any], list[dict[str, Any]]]]:
    """Give each dataset with its conditions; of each, rows of (column, text) that share its id."""
    for dataset in board["datasets"]:
        conditions = [
            {
                "name": condition,
                "rows": [
                    {
                        "cell": _cell(row),
                        "reason": row["reason"],
                        "columns": [(column, shown(column, row[column])) for column in SHOWN],
                    }
                    for row in rows
                ],
            }
            for condition, rows in groupby(dataset["rows"], key=lambda row: row["condition"])
        ]
        yield dataset, conditions


def _to_markdown(board: Board) -> str:
    lines = ["# Leaderboard", "", LEGEND, ""]
    for dataset, conditions in _tables(board):
        architecture = f"{dataset['detector']}, {dataset['mask']}; version {dataset['version']}"
        lines += [f"## {dataset['name']}", "", architecture, ""]
        for condition in conditions:
            lines += [f"### {condition['name']}", "", f"| {' | '.join(SHOWN.values())} |"]
            lines.append("|" + "|".join(_rule(column) for column in SHOWN) + "|")
            for row in condition["rows"]:
                lines.append(f"| {' | '.join(text for _, text in row['columns'])} |")
            unscored = [row for row in condition["rows"] if row["reason"]]
            lines += ["", *(f"No score: {row['cell']}: {row['reason']}" for row in unscored)]
            lines += [""] if unscored else []
    lines += sweep_tables.to_markdown(board["sweeps"])
    return "\n".join(lines).rstrip("\n") + "\n"


def _rule(column: str) -> str:
    return " --- " if column in ("extractor", "model") else " ---: "


def _from_markdown(text: str) -> Cells:
    datasets, _, sweeps = text.partition(f"\n# {sweep_tables.HEADING}\n")
    found = sweep_tables.from_markdown(sweeps)
    dataset = condition = ""
    for line in datasets.splitlines():
        if line.startswith("## "):
            dataset = line[3:]
        elif line.startswith("### "):
            condition = line[4:]
        elif line.startswith("|") and not line.startswith(("| # |", "| ---")):
            values = [value.strip() for value in line.strip("|").split("|")]
            row = dict(zip(SHOWN, values, strict=False))
            cell = f"{dataset}/{condition}/{row.get('extractor')}/{row.get('model')}"
            found |= {(cell, column): value for column, value in row.items()}
    return found


def _to_html(board: Board) -> str:
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
        tables=list(_tables(board)),
        headings=SHOWN,
        legend=LEGEND,
        sweeps=sweep_tables.tables(board["sweeps"]),
        unmeasured=sweep_tables.unmeasured(board["sweeps"]),
        sweep_legend=sweep_tables.LEGEND,
    )


class _TableReader(HTMLParser):
    """Reads the cells our own template marks with data-cell and data-column."""

    def __init__(self) -> None:
        super().__init__()
        self.found: Cells = {}
        self._row = ""
        self._cell = ""
        self._column = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        if tag == "tr":
            self._row = given.get("data-cell") or ""
        elif tag in ("td", "th") and self._row:
            self._cell = given.get("data-cell") or self._row
            self._column = given.get("data-column") or ""
            self.found[self._cell, self._column] = ""

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th"):
            self._column = ""

    def handle_data(self, data: str) -> None:
        if self._row and self._column:
            self.found[self._cell, self._column] += data


def _from_html(text: str) -> Cells:
    reader = _TableReader()
    reader.feed(text)
    return reader.found


def _cell(row: Mapping[str, Any]) -> str:
    return "/".join(str(row.get(name)) for name in IDENTITY)


def _plain(value: object) -> str:
    return "" if value is None else str(value)


FORMATS = {
    "leaderboard.json": Format(_to_json, _from_json),
    "leaderboard.csv": Format(_to_csv, _from_csv),
    "sweeps.csv": Format(lambda board: sweep_tables.to_csv(board["sweeps"]), sweep_tables.from_csv),
    "leaderboard.md": Format(_to_markdown, _from_markdown),
    "leaderboard.html": Format(_to_html, _from_html),
}
