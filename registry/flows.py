"""Flows of studies through a chain of attributes: what the survey's Sankey diagrams show.

A study with several values at a level flows through every combination of its values, because the
mapping says which values a study has and not which of them belong together. Nothing else is
linked: two values meet in a link only if one study has both. Levels implied by the same attribute
(`model_category` and `model`) move together, so a category links to its own models only.
"""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import Any, Literal

from registry import studies as registered
from registry.studies import Facts, Study
from registry.taxonomy import InvalidValueError, Taxonomy, attribute_of, unknown_name
from survey_data.json_data import JsonData

Counting = Literal["studies", "fractional"]
COUNTINGS: tuple[Counting, ...] = ("studies", "fractional")

Where = Mapping[str, str | Collection[str]]
"""Level -> the values to keep: a study counts if it has one of them at every level named, and
flows only through those it has."""

CHARTS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "error": ("error", "detector", "mask"),
        "performance": ("accuracy", "mask", "model_category"),
        "cross-analysis": ("task", "detector", "mask", "model", "extractor"),
        "task": ("task", "detector", "mask"),
        "model-sunburst": ("model_category", "calibration", "model"),
    }
)
"""The survey's figures: errorsankey, perfsankey, casankey, its task diagram, modelsunburst."""

_GROUPED = {"model": "model_category", "extractor": "extractor_family"}


@dataclass(frozen=True)
class Node(JsonData):
    """A value at a level. ``count`` is its studies' number, or their weight if fractional."""

    id: str
    level: str
    value: str
    name: str
    count: float
    studies: tuple[str, ...]


@dataclass(frozen=True)
class Link(JsonData):
    """The studies that have both values; ``source`` and ``target`` are node ids."""

    source: str
    target: str
    value: float
    studies: tuple[str, ...]


@dataclass(frozen=True)
class LeftOut(JsonData):
    """The studies without a value at a level: missing from its links, not from the count."""

    level: str
    studies: tuple[str, ...]

    def to_dict(self) -> dict[str, object]:
        """As in the HTTP answer."""
        return {"level": self.level, "count": len(self.studies), "studies": list(self.studies)}


@dataclass(frozen=True)
class Flows(JsonData):
    """Nodes and links of a chain of levels.

    ``studies`` are all that met the filter; those of them without a value at some level stand in
    ``left_out``. Counting studies, they still count at the levels where they have values;
    fractionally they are left out of the whole chart, so that inflow equals outflow.
    """

    chart: str | None
    levels: tuple[str, ...]
    counting: Counting
    studies: tuple[str, ...]
    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    left_out: tuple[LeftOut, ...]

    def to_dict(self) -> dict[str, object]:
        """Return it as JSON data, with the number of studies."""
        left_out = [left.to_dict() for left in self.left_out]
        return {**super().to_dict(), "studies": len(self.studies), "left_out": left_out}


def chart(
    name: str,
    where: Where | None = None,
    counting: Counting = "studies",
    *,
    grouped: bool = False,
    facts: Facts | None = None,
) -> Flows:
    """One of the survey's charts; ``grouped`` shows categories instead of models and extractors.

    Raises InvalidValueError naming the nearest chart, level or value.
    """
    if name not in CHARTS:
        raise unknown_name("chart", name, CHARTS)
    levels = CHARTS[name]
    if grouped:
        # Where the chart already has the category, its detail adds nothing and is dropped.
        levels = tuple(dict.fromkeys(_GROUPED.get(level, level) for level in levels))
    return _flows(name, levels, where or {}, counting, facts or registered.facts())


def flows(
    levels: Sequence[str],
    where: Where | None = None,
    counting: Counting = "studies",
    facts: Facts | None = None,
) -> Flows:
    """Flows of studies through `levels`, left to right.

    Parameters
    ----------
    levels : sequence of str
        Two or more different attributes or pseudo-levels (`registry.taxonomy.LEVELS`).
    where : mapping of level to value or values, optional
        Keeps studies that have one of the values at each level named (a parent such as ECM stands
        for its kinds too), and of those studies only these values.
    counting : {"studies", "fractional"}
        Distinct studies on a link; or each study as weight 1, split evenly over the different
        combinations of its values at `levels`.
    facts : Facts, optional
        The survey's by default.

    Raises
    ------
    InvalidValueError
        For an unknown level, value or counting, or a chain of fewer than two different levels.
    """
    return _flows(None, tuple(levels), where or {}, counting, facts or registered.facts())


def allowed_values(where: Where, taxonomy: Taxonomy) -> dict[str, frozenset[str]]:
    """Attribute -> the values that meet every condition on it or on a level it implies."""
    allowed: dict[str, frozenset[str]] = {}
    for level, wanted in where.items():
        if level not in taxonomy.levels:
            raise unknown_name("level", level, taxonomy.levels)
        base = attribute_of(level)
        values: set[str] = set()
        for value in (wanted,) if isinstance(wanted, str) else wanted:
            taxonomy.require(level, value)
            values.update(taxonomy.kinds(level, value) if level == base else (value,))
        matching = frozenset(
            v for v in taxonomy.values(base) if taxonomy.derived_values(level, v) in values
        )
        allowed[base] = allowed.get(base, matching) & matching
    return allowed


def _flows(
    name: str | None, levels: tuple[str, ...], where: Where, counting: str, facts: Facts
) -> Flows:
    taxonomy = facts.taxonomy
    _check_levels(levels, taxonomy)
    if counting not in COUNTINGS:
        raise unknown_name("counting", counting, COUNTINGS)
    mode: Counting = "fractional" if counting == "fractional" else "studies"
    allowed = allowed_values(where, taxonomy)
    met = [study for study in facts.studies.values() if _meets(study, allowed)]

    on_node: dict[tuple[int, str], dict[str, Fraction]] = {}
    on_link: dict[tuple[int, str, str], dict[str, Fraction]] = {}
    left_out: dict[str, list[str]] = {}
    for study in met:
        combinations = _combinations(study, levels, allowed, taxonomy)
        missing = [at for at, value in enumerate(combinations[0]) if value is None]
        for at in missing:
            left_out.setdefault(levels[at], []).append(study.key)
        if missing and mode == "fractional":
            continue
        share = Fraction(1, len(combinations))
        for combination in combinations:
            for at, (value, following) in enumerate(itertools.pairwise((*combination, None))):
                if value is not None:
                    weights = on_node.setdefault((at, value), {})
                    weights[study.key] = weights.get(study.key, 0) + share
                if value is not None and following is not None:
                    weights = on_link.setdefault((at, value, following), {})
                    weights[study.key] = weights.get(study.key, 0) + share
    nodes, links = drawn(levels, on_node, on_link, taxonomy, mode)
    return Flows(
        chart=name,
        levels=levels,
        counting=mode,
        studies=tuple(study.key for study in met),
        nodes=nodes,
        links=links,
        left_out=tuple(
            LeftOut(level, tuple(left_out[level])) for level in levels if level in left_out
        ),
    )


def drawn(
    levels: Sequence[str],
    on_node: Mapping[tuple[int, str], Mapping[str, Fraction]],
    on_link: Mapping[tuple[int, str, str], Mapping[str, Fraction]],
    taxonomy: Taxonomy,
    counting: Counting = "studies",
) -> tuple[tuple[Node, ...], tuple[Link, ...]]:
    """Return the nodes and links of a chart, in its order.

    `on_node` and `on_link` are weights by study of a value at the level of a position, and of such
    a value and one at the next level.
    """
    order = [{v: i for i, v in enumerate(taxonomy.values(level))} for level in levels]

    def count(weights: Mapping[str, Fraction]) -> float:
        return float(sum(weights.values())) if counting == "fractional" else len(weights)

    def place(key: tuple[Any, ...]) -> tuple[int, ...]:
        return key[0], *(order[key[0] + i][value] for i, value in enumerate(key[1:]))

    nodes = (
        Node(f"{level}:{value}", level, value, taxonomy.name(level, value), count(on), tuple(on))
        for at, value in sorted(on_node, key=place)
        for level, on in [(levels[at], on_node[at, value])]
    )
    links = (
        Link(f"{levels[at]}:{one}", f"{levels[at + 1]}:{other}", count(on), tuple(on))
        for at, one, other in sorted(on_link, key=place)
        for on in [on_link[at, one, other]]
    )
    return tuple(nodes), tuple(links)


def _check_levels(levels: tuple[str, ...], taxonomy: Taxonomy) -> None:
    for level in levels:
        if level not in taxonomy.levels:
            raise unknown_name("level", level, taxonomy.levels)
    if len(levels) < 2 or len(set(levels)) < len(levels):
        raise InvalidValueError("levels", ",".join(levels), "two or more different levels")


def _meets(study: Study, allowed: Mapping[str, frozenset[str]]) -> bool:
    return all(not values.isdisjoint(study.of(a)) for a, values in allowed.items())


def _combinations(
    study: Study,
    levels: tuple[str, ...],
    allowed: Mapping[str, frozenset[str]],
    taxonomy: Taxonomy,
) -> list[tuple[str | None, ...]]:
    """Return the different combinations of a study's values at `levels`; None where it has none."""
    bases = tuple(dict.fromkeys(attribute_of(level) for level in levels))
    at = [bases.index(attribute_of(level)) for level in levels]
    choices: list[Iterable[str | None]] = [
        [v for v in study.of(base) if base not in allowed or v in allowed[base]] or [None]
        for base in bases
    ]
    return list(
        dict.fromkeys(
            tuple(
                None if (value := row[i]) is None else taxonomy.derived_values(level, value)
                for level, i in zip(levels, at, strict=True)
            )
            for row in itertools.product(*choices)
            if study.has_sensor(dict(zip(bases, row, strict=True)))
        )
    )
