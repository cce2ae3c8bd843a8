"""The sunburst of model representations: categories, ground or orbit, models.

A study with several models stands in each of them, so that a ring inside is as wide as what it
holds and counts its different studies beside.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure
from api.figures.specification import HOVER, TEXT, Plotly, colour, faint, mark, specification
from api.schema.figures import ArcRow
from api.schema.table import columns_of
from registry.flows import Where, flows
from registry.studies import Facts
from registry.taxonomy import NO_IMPLEMENTATION_STATED, Taxonomy

NAME = "models"
TITLE = "Model representations"
CAPTION = (
    "Kinds of calibration model (inner ring), whether they are calibrated on the ground or in "
    "operation (middle ring), and the models themselves."
)
LEVELS = ("model_category", "calibration", "model")


_RINGS = (0.6, 0.42, 0.3)  # how strong the colours of each ring are, from inside


@dataclass(frozen=True)
class _Leaf:
    path: tuple[str, str, str]
    studies: tuple[str, ...]


def sunburst_figure(facts: Facts, addresses: Addresses, where: Where) -> Figure:
    """Return the sunburst of the studies that meet `where`."""
    taxonomy = facts.taxonomy
    found = flows(LEVELS, where, facts=facts)
    leaves = [
        _Leaf(
            (
                taxonomy.derived_values("model_category", node.value),
                taxonomy.derived_values("calibration", node.value),
                node.value,
            ),
            node.studies,
        )
        for node in found.nodes
        if node.level == "model"
    ]
    rows: list[dict[str, Any]] = []

    def add(path: tuple[str, ...]) -> None:
        """Append the row of a part, then those of what it holds."""
        inside = [leaf for leaf in leaves if leaf.path[: len(path)] == path]
        keys = tuple(dict.fromkeys(key for leaf in inside for key in leaf.studies))
        level = LEVELS[len(path) - 1]
        rows.append(
            {
                "level": level,
                **dict.fromkeys(LEVELS, ""),
                **dict(zip(LEVELS, path, strict=False)),
                "name": wording.value_name(taxonomy, level, path[-1]),
                "count": len(keys),
                "memberships": sum(len(leaf.studies) for leaf in inside),
                "studies": list(keys),
            }
        )
        for further in [] if len(path) == 3 else _following(leaves, path):
            add(further)

    for path in _following(leaves, ()):
        add(path)
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(rows, len(found.studies)),
        columns=columns_of(ArcRow),
        rows=tuple(rows),
        plotly=_plotly(rows, taxonomy, addresses),
        studies=len(found.studies),
        left_out=found.left_out,
    )


def _plotly(rows: Sequence[Mapping[str, Any]], taxonomy: Taxonomy, addresses: Addresses) -> Plotly:
    places = {value: at for at, value in enumerate(taxonomy.values("model_category"))}
    arcs: dict[str, list[Any]] = {
        name: [] for name in ("ids", "parents", "labels", "values", "customdata", "colors")
    }
    for at, row in enumerate(rows):
        level, category = row["level"], row["model_category"]
        if category == NO_IMPLEMENTATION_STATED and level != LEVELS[0]:
            continue  # what has no model has no ground or orbit either: one arc says it
        path = [row[ring] for ring in LEVELS if row[ring]]
        given = {} if level == "calibration" else {level: row[level]}
        within = f"{wording.display_name(LEVELS[0], category)}, " if not given else ""
        said = wording.value_label(taxonomy, level, row[level])
        row_of_page = f"{addresses.page}#row-{at}"
        href = addresses.of(row["studies"], given, at) if given else row_of_page
        arcs["ids"].append(" > ".join(path))
        arcs["parents"].append(" > ".join(path[:-1]))
        arcs["labels"].append(wording.display_name(level, row[level]))
        arcs["values"].append(row["memberships"])
        arcs["customdata"].append(mark(f"{within}{said}: {wording.studies(row['count'])}", href))
        arcs["colors"].append(faint(colour(places[category]), _RINGS[len(path) - 1]))
    trace = {
        "type": "sunburst",
        **{name: of for name, of in arcs.items() if name != "colors"},
        "marker": {"colors": arcs["colors"]},
        "branchvalues": "total",
        "insidetextorientation": "radial",
        "insidetextfont": {"color": TEXT},
        "hovertemplate": HOVER,
    }
    margin = {"l": 8, "r": 8, "t": 8, "b": 8}
    return specification([trace] if rows else [], height=640, margin=margin)


def _following(leaves: list[_Leaf], path: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the sectors inside a path, those with most studies first."""
    size: dict[tuple[str, ...], int] = {}
    for leaf in leaves:
        if leaf.path[: len(path)] == path:
            further = leaf.path[: len(path) + 1]
            size[further] = size.get(further, 0) + len(leaf.studies)
    return sorted(size, key=lambda further: -size[further])


def _text(rows: Sequence[Mapping[str, Any]], studies: int) -> tuple[str, ...]:
    categories = [row for row in rows if row["level"] == LEVELS[0]]
    names = [wording.display_name(LEVELS[0], row["model_category"]) for row in categories]
    parts = [f"{name} {row['count']}" for name, row in zip(names, categories, strict=True)]
    rings = "in three rings; by category, with the number of different studies"
    said = [f"Models of {wording.studies(studies)} {rings}: {wording.join_words(parts) or 'none'}."]
    for name, category in zip(names, categories, strict=True):
        models = [
            row
            for row in rows
            if row["model"] and row["model_category"] == category["model_category"]
        ]
        if category["model_category"] != NO_IMPLEMENTATION_STATED:
            most = max(models, key=lambda model: model["count"])
            said.append(
                f"{name}: {wording.plural(len(models), 'model')}, most often "
                f"{most['name']} ({most['count']})."
            )
    return tuple(said)
