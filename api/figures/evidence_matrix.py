"""The evidence map: pairs of values of two attributes, as studied, measured, or why neither.

Each pair is in one of the five states of `registry.evidence`; what is not measured leads to what
could be.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.addresses import architecture_page, dataset_page
from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure, in_words
from api.figures.specification import HOVER, LINE, SURFACE, Plotly, axis, mark, scale, specification
from api.schema.figures import PairRow
from api.schema.table import columns_of
from benchmark.leaderboard.summaries import digits
from registry.evidence import Evidence, PairEvidence, PipelineRun, count
from registry.flows import LeftOut, Node, Where, allowed_values, flows
from registry.possibility import RULE, Value
from registry.studies import Facts
from registry.taxonomy import Taxonomy, attribute_of, unknown_name

NAME = "matrix"
TITLE = "Evidence map"
_STATES = ("measured", "unknown", "unstudied", "impossible")
"""States of a pair without a study, in the order of their colours."""
_SIGNS = {"measured": "•", "unknown": "?", "unstudied": "", "impossible": "×"}


def matrix_figure(
    facts: Facts, addresses: Addresses, where: Where, evidence: Evidence, *, rows: str, columns: str
) -> Figure:
    """Return the matrix of the studies that meet `where`, by two attributes or levels.

    Raises
    ------
    InvalidValueError
        For a level that is not known, naming those that are; for `where` as
        `registry.flows.flows`.
    """
    taxonomy = facts.taxonomy
    for name, level in (("rows", rows), ("columns", columns)):
        if level not in taxonomy.levels:
            raise unknown_name(name, level, taxonomy.levels)
    # A study has a value together with itself too: an attribute by itself shows what goes together.
    other = columns if rows != columns else next(v for v in taxonomy.levels if v != rows)
    found = flows((rows, other), where, facts=facts)
    nodes = {node.id: node for node in found.nodes}
    behind = {(link.source, link.target): link.studies for link in found.links}
    if rows == columns:
        alike = [node for node in found.nodes if node.level == rows]
        behind = {
            (a.id, b.id): tuple(key for key in a.studies if key in b.studies)
            for a in alike
            for b in alike
        }
    left_out = tuple(left for left in found.left_out if left.level in (rows, columns))
    blank = {left.level: set(left.studies) for left in left_out}

    def might(value: Value, level: str) -> list[str]:
        """Return the studies with a value that say nothing at the other level."""
        node = nodes.get(":".join(value))
        return [] if node is None else [key for key in node.studies if key in blank.get(level, ())]

    values = {level: _values(taxonomy, level, where) for level in (rows, columns)}
    table: list[dict[str, Any]] = []
    marks: list[dict[str, Any]] = []
    for row in values[rows]:
        for column in values[columns]:
            keys = behind.get((f"{rows}:{row}", f"{columns}:{column}"), ())
            pair = (rows, row), (columns, column)
            unknown = sorted({*might(pair[0], columns), *might(pair[1], rows)})
            known = evidence.of(*pair, keys, unknown)
            cell_evidence = _evidence_members(pair, known)
            given = {rows: row, columns: column}
            href = (
                addresses.of(keys, given, len(table)) if keys else cell_evidence["leads_to"] or None
            )
            marks.append(mark(_title(pair, len(keys), known), href))
            table.append(
                {
                    "row_level": rows,
                    "row": row,
                    "row_name": wording.value_name(taxonomy, rows, row),
                    "column_level": columns,
                    "column": column,
                    "column_name": wording.value_name(taxonomy, columns, column),
                    "state": known.state,
                    "count": len(keys),
                    "studies": list(keys),
                    **cell_evidence,
                }
            )
    lines = {
        level: [_line(level, value, nodes) for value in values[level]] for level in (rows, columns)
    }
    heads = (wording.LEVELS[rows], wording.LEVELS[columns])
    return Figure(
        name=NAME,
        title=f"{TITLE}: {heads[0].lower()} by {heads[1].lower()}",
        caption="How many studies have both values, and which pairs are measured here (•); of the "
        "others, which are impossible (×), unknown (?) or unstudied (empty).",
        text=_text(table, lines[rows], lines[columns], heads, left_out),
        studies=len(found.studies),
        left_out=left_out,
        columns=columns_of(PairRow),
        rows=tuple(table),
        plotly=_plotly(table, marks, (lines[rows], lines[columns])),
        options={"rows": rows, "columns": columns},
        counts=count(row["state"] for row in table),
    )


def _evidence_members(pair: tuple[Value, Value], known: PairEvidence) -> dict[str, Any]:
    """Return what the table tells of a pair besides its studies."""
    best = known.best_pipeline
    command = leads_to = ""
    if best is not None:
        command = PipelineRun(best.dataset, best.extractor, best.model).command
        sensor = dict(pair)
        leads_to = dataset_page(best.dataset)
        if sensor.keys() == {"detector", "mask"}:
            leads_to = architecture_page(sensor["detector"], sensor["mask"])
    elif known.state == "impossible":
        pass
    elif known.possible_run is not None:
        command, leads_to = known.possible_run.command, dataset_page(known.possible_run.dataset)
    elif known.nearest_dataset:
        command = f"sunatlas benchmark --dataset {known.nearest_dataset}"
        leads_to = dataset_page(known.nearest_dataset)
    return {
        "reason": known.reason,
        "unknown": list(known.unknown),
        "pipelines": known.pipelines,
        "best_own_error_deg": None if best is None else best.nominal.rms_deg,
        "best_dataset": None if best is None else best.dataset,
        "best_extractor": None if best is None else best.extractor,
        "best_model": None if best is None else best.model,
        "command": command,
        "leads_to": leads_to,
    }


def _title(pair: tuple[Value, Value], count: int, known: PairEvidence) -> str:
    """Return what is said of a pair's cell where it is pointed at."""
    said = " × ".join(wording.display_name(level, value) for level, value in pair)
    parts = [wording.studies(count) if count else "no study"]
    if known.pipelines:
        parts.append(f"{wording.plural(known.pipelines, 'pipeline')} measured here")
    if (best := known.best_pipeline) is not None:
        parts.append(f"best own error {digits(best.nominal.rms_deg)}° on {best.dataset}")
    if known.state == "impossible":
        parts.append(f"impossible ({known.reason})")
    if known.state == "unknown":
        parts.append(f"the other value of {wording.studies(len(known.unknown))} is unknown")
    return f"{said}: {', '.join(parts)}"


def _plotly(
    table: Sequence[Mapping[str, Any]],
    marks: Sequence[Mapping[str, Any]],
    lines: tuple[Sequence[_Line], Sequence[_Line]],
) -> Plotly:
    """Return two heatmaps of the same cells: numbers of studies, and states where there is none."""
    rows, columns = lines
    across = len(columns)

    def by_row(cells: Sequence[Any]) -> list[list[Any]]:
        return [list(cells[at : at + across]) for at in range(0, len(cells), across)]

    shared = {
        "type": "heatmap",
        "x": [column.label for column in columns],
        "y": [row.label for row in rows],
        "customdata": by_row(marks),
        "hovertemplate": HOVER,
        "texttemplate": "%{text}",
        "hoverongaps": False,
        "showscale": False,
        "xgap": 2,
        "ygap": 2,
    }
    measured = ["•" if row["pipelines"] else "" for row in table]
    studied = {
        "z": by_row([row["count"] or None for row in table]),
        "text": by_row(
            [
                f"{row['count']}{dot}" if row["count"] else ""
                for row, dot in zip(table, measured, strict=True)
            ]
        ),
        "colorscale": scale(),
        "zmin": 1,
        "zmax": max([2, *(row["count"] for row in table)]),
    }
    states = {
        "z": by_row([None if row["count"] else _STATES.index(row["state"]) for row in table]),
        "text": by_row([_SIGNS.get(row["state"], "") for row in table]),
        "colorscale": scale((SURFACE, SURFACE, SURFACE, LINE)),
        "zmin": 0,
        "zmax": len(_STATES) - 1,
    }
    names = [[f"{line.label} ({line.count})" for line in of] for of in lines]
    return specification(
        [{**shared, **states}, {**shared, **studied}],
        height=110 + 30 * len(rows),
        narrowest=160 + 42 * across,
        xaxis=axis(
            side="top", tickangle=-40, tickvals=shared["x"], ticktext=names[1], showgrid=False
        ),
        yaxis=axis(autorange="reversed", tickvals=shared["y"], ticktext=names[0], showgrid=False),
    )


def _values(taxonomy: Taxonomy, level: str, where: Where) -> Sequence[str]:
    """Return the values of a level that the filters leave, in the taxonomy's order."""
    base = attribute_of(level)
    allowed = allowed_values(where, taxonomy).get(base)
    if allowed is None:
        return taxonomy.values(level)
    left = {taxonomy.derived_values(level, value) for value in allowed}
    return [value for value in taxonomy.values(level) if value in left]


@dataclass(frozen=True)
class _Line:
    """A row or a column: its label and number of studies."""

    label: str
    count: int


def _line(level: str, value: str, nodes: Mapping[str, Node]) -> _Line:
    node = nodes.get(f"{level}:{value}")
    return _Line(wording.display_name(level, value), 0 if node is None else len(node.studies))


def _text(
    table: Sequence[Mapping[str, Any]],
    rows: Sequence[_Line],
    columns: Sequence[_Line],
    heads: tuple[str, str],
    left_out: Sequence[LeftOut],
) -> tuple[str, ...]:
    counts = count(row["state"] for row in table)
    without = sum(row["state"] == "measured" and not row["count"] for row in table)
    fullest = max(table, key=lambda row: row["count"], default=None)
    size = f"{heads[0]} ({len(rows)} values) by {heads[1].lower()} ({len(columns)} values)"
    states = (
        f"{counts['measured']} measured here, {without} of them without a study; "
        f"{counts['studied']} studied and not measured; {counts['impossible']} impossible; "
        f"{counts['unknown']} unknown, as a cell of a study is; {counts['unstudied']} unstudied"
    )
    said = [f"{size}, {len(table)} pairs: {states}."]
    if fullest is not None and fullest["count"]:
        pair = " with ".join(
            wording.display_name(fullest[f"{side}_level"], fullest[side])
            for side in ("row", "column")
        )
        said.append(f"Most studied: {pair}, {wording.studies(fullest['count'])}.")
    for head, lines in zip(heads, (rows, columns), strict=True):
        unused = [line.label for line in lines if not line.count]
        if unused:
            said.append(f"{head} without any study: {wording.join_words(unused)}.")
    if counts["impossible"]:
        said.append(RULE)
    missing = in_words(left_out, wording.LEVELS)
    return (*said, missing) if missing else tuple(said)
