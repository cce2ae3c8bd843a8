"""The evidence map: studies by two attributes, what nobody studied as visible as what many did."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from api import columns as table_columns
from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure, in_words
from api.figures.matrix_drawing import Cell, Line, draw_matrix
from registry.flows import LeftOut, Node, Where, allowed_values, flows
from registry.studies import Facts
from registry.taxonomy import Taxonomy, attribute_of, unknown_name

NAME = "matrix"
TITLE = "Evidence map"
ROWS, COLUMNS_OF = "detector", "mask"
"""What is shown where nothing else is asked for."""


def matrix_figure(
    facts: Facts,
    addresses: Addresses,
    where: Where,
    rows: str = ROWS,
    columns: str = COLUMNS_OF,
) -> Figure:
    """Return the matrix of the studies that meet `where`, by two attributes or levels.

    Raises
    ------
    InvalidValueError
        For a level that is not known, naming those that are.
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
    values = {level: _values(taxonomy, level, where) for level in (rows, columns)}
    table: list[dict[str, Any]] = []
    cells: dict[tuple[str, str], Cell] = {}
    for row in values[rows]:
        for column in values[columns]:
            if not possible(taxonomy, (rows, row), (columns, column)):
                continue
            keys = behind.get((f"{rows}:{row}", f"{columns}:{column}"), ())
            said = f"{wording.shown(rows, row)} × {wording.shown(columns, column)}"
            given = {rows: row, columns: column}
            href = addresses.of(keys, given, len(table)) if keys else None
            title = f"{said}: {wording.studies(len(keys)) if keys else 'no study'}"
            cells[row, column] = Cell(len(keys), title, href)
            table.append(
                {
                    "row_level": rows,
                    "row": row,
                    "row_name": wording.named(taxonomy, rows, row),
                    "column_level": columns,
                    "column": column,
                    "column_name": wording.named(taxonomy, columns, column),
                    "count": len(keys),
                    "studies": list(keys),
                }
            )
    lines = {
        level: [_line(taxonomy, level, value, nodes) for value in values[level]]
        for level in (rows, columns)
    }
    heads = (wording.LEVELS[rows], wording.LEVELS[columns])
    return Figure(
        name=NAME,
        title=f"{TITLE}: {heads[0].lower()} by {heads[1].lower()}",
        caption="How many studies have both values; a dashed cell is a pair that no study has.",
        text=_text(table, lines[rows], lines[columns], heads, left_out),
        studies=len(found.studies),
        left_out=left_out,
        columns=table_columns.FIGURE_MATRIX,
        rows=tuple(table),
        draw=lambda width: draw_matrix(lines[rows], lines[columns], cells, heads, width=width),
        options={"rows": rows, "columns": columns},
    )


def possible(taxonomy: Taxonomy, row: tuple[str, str], column: tuple[str, str]) -> bool:
    """Say whether two (level, value) can belong to one value: a model is of one category only."""
    (rows, one), (columns, other) = row, column
    base = attribute_of(rows)
    if rows == columns or base != attribute_of(columns):
        return True
    return any(
        taxonomy.derived(rows, value) == one and taxonomy.derived(columns, value) == other
        for value in taxonomy.values(base)
    )


def _values(taxonomy: Taxonomy, level: str, where: Where) -> Sequence[str]:
    """Return the values of a level that the filters leave, in the taxonomy's order."""
    base = attribute_of(level)
    allowed = allowed_values(where, taxonomy).get(base)
    if allowed is None:
        return taxonomy.values(level)
    left = {taxonomy.derived(level, value) for value in allowed}
    return [value for value in taxonomy.values(level) if value in left]


def _line(taxonomy: Taxonomy, level: str, value: str, nodes: Mapping[str, Node]) -> Line:
    node = nodes.get(f"{level}:{value}")
    count = 0 if node is None else len(node.studies)
    said = wording.spelt(taxonomy, level, value)
    title = f"{wording.LEVELS[level]} {said}: {wording.studies(count) if count else 'no study'}"
    return Line(value, wording.shown(level, value), count, title)


def _text(
    table: Sequence[Mapping[str, Any]],
    rows: Sequence[Line],
    columns: Sequence[Line],
    heads: tuple[str, str],
    left_out: Sequence[LeftOut],
) -> tuple[str, ...]:
    empty = sum(row["count"] == 0 for row in table)
    fullest = max(table, key=lambda row: row["count"], default=None)
    size = f"{heads[0]} ({len(rows)} values) by {heads[1].lower()} ({len(columns)} values)"
    said = [f"{size}: {empty} of {len(table)} pairs have no study."]
    if fullest is not None and fullest["count"]:
        pair = " with ".join(
            wording.shown(fullest[f"{side}_level"], fullest[side]) for side in ("row", "column")
        )
        said.append(f"Most studied: {pair}, {wording.studies(fullest['count'])}.")
    for head, lines in zip(heads, (rows, columns), strict=True):
        unused = [line.label for line in lines if not line.count]
        if unused:
            said.append(f"{head} without any study: {wording.listed(unused)}.")
    missing = in_words(left_out, wording.LEVELS)
    return (*said, missing) if missing else tuple(said)
