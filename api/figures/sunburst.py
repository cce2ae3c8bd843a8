"""The sunburst of model representations: categories, ground or orbit, models.

A study with several models stands in each of them, so that a ring inside is as wide as what it
holds and counts its different studies beside.
"""

from __future__ import annotations

from dataclasses import dataclass

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure
from api.figures.sunburst_svg import Sector, draw_sunburst
from api.schema.figures import ArcRow
from api.schema.table import columns_of
from registry.flows import Where, flows
from registry.studies import Facts
from registry.taxonomy import NO_IMPLEMENTATION_STATED

NAME = "models"
TITLE = "Model representations"
CAPTION = (
    "Kinds of calibration model (inner ring), whether they are calibrated on the ground or in "
    "operation (middle ring), and the models themselves."
)
LEVELS = ("model_category", "calibration", "model")


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
    rows: list[dict[str, object]] = []

    def sector(path: tuple[str, ...], colour: int) -> Sector:
        inside = [leaf for leaf in leaves if leaf.path[: len(path)] == path]
        keys = tuple(dict.fromkeys(key for leaf in inside for key in leaf.studies))
        level, value = LEVELS[len(path) - 1], path[-1]
        given = {"model_category": path[0]} if len(path) == 1 else {}
        if len(path) == 3:
            given = {"model": value}
        said = wording.value_label(taxonomy, level, value)
        within = f"{wording.display_name(LEVELS[0], path[0])}, " if len(path) == 2 else ""
        memberships = sum(len(leaf.studies) for leaf in inside)
        row = len(rows)
        rows.append(
            {
                "level": level,
                **dict.fromkeys(LEVELS, ""),
                **dict(zip(LEVELS, path, strict=False)),
                "name": wording.value_name(taxonomy, level, value),
                "count": len(keys),
                "memberships": memberships,
                "studies": list(keys),
            }
        )
        # What has no model has no ground or orbit either: one arc says it.
        empty = value == NO_IMPLEMENTATION_STATED and level == "model_category"
        following = [] if len(path) == 3 else _following(leaves, path)
        inner = [sector(further, colour) for further in following]
        return Sector(
            label=wording.display_name(level, value),
            name=wording.value_name(taxonomy, level, value),
            count=len(keys),
            size=memberships,
            colour=colour,
            title=f"{within}{said}: {wording.studies(len(keys))}",
            href=addresses.of(keys, given, row) if given else f"{addresses.page}#row-{row}",
            inside=() if empty else tuple(inner),
        )

    colours = {value: at % 8 + 1 for at, value in enumerate(taxonomy.values("model_category"))}
    sectors = tuple(sector(path, colours[path[0]]) for path in _following(leaves, ()))
    return Figure(
        name=NAME,
        title=TITLE,
        caption=CAPTION,
        text=_text(sectors, len(found.studies)),
        studies=len(found.studies),
        left_out=found.left_out,
        columns=columns_of(ArcRow),
        rows=tuple(rows),
        draw=lambda width: draw_sunburst(sectors, width),
    )


def _following(leaves: list[_Leaf], path: tuple[str, ...]) -> list[tuple[str, ...]]:
    """Return the sectors inside a path, those with most studies first."""
    size: dict[tuple[str, ...], int] = {}
    for leaf in leaves:
        if leaf.path[: len(path)] == path:
            further = leaf.path[: len(path) + 1]
            size[further] = size.get(further, 0) + len(leaf.studies)
    return sorted(size, key=lambda further: -size[further])


def _text(sectors: tuple[Sector, ...], studies: int) -> tuple[str, ...]:
    parts = [f"{sector.label} {sector.count}" for sector in sectors]
    rings = "in three rings; by category, with the number of different studies"
    said = [f"Models of {wording.studies(studies)} {rings}: {wording.join_words(parts) or 'none'}."]
    for sector in sectors:
        models = [model for ring in sector.inside for model in ring.inside]
        if models:
            most = max(models, key=lambda model: model.count)
            said.append(
                f"{sector.label}: {wording.plural(len(models), 'model', 'models')}, most often "
                f"{most.name} ({most.count})."
            )
    return tuple(said)
