"""The decision flow behind an answer: the paths of studies that lead to its designs."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from registry.answer import Answer
from registry.design_table import DesignTable
from registry.flows import Counting, LeftOut, Link, Node, drawn
from registry.studies import Facts, Study

PATH_LEVELS = ("task", "detector", "mask", "model", "extractor")
GROUPED_LEVELS = (*PATH_LEVELS[:3], "model_category", "extractor_family")

Path = tuple[str, ...]


@dataclass(frozen=True)
class AnswerFlow:
    """Paths from task to extractor with their studies, and the nodes and links they make up."""

    levels: tuple[str, ...]
    paths: Mapping[Path, tuple[str, ...]]
    nodes: tuple[Node, ...]
    links: tuple[Link, ...]
    left_out: tuple[LeftOut, ...]


def answer_flow(
    answer: Answer, counting: Counting = "studies", *, grouped: bool = False
) -> AnswerFlow:
    """Return the paths that studies took to the designs of an answer.

    Nodes and links have models and extractors by their families where `grouped`, and are counted as
    `registry.flows.flows` counts.

    A path exists if one study has all five of its values, on a sensor that it can have had; what a
    study only compared is none of its values here.
    """
    question = answer.question
    table, asked = question.table, question.requirements
    matching = question.matching_designs
    tasks = set(asked.include.get("task", ())) or set(table.facts.taxonomy.values("task"))
    tasks -= {*asked.exclude.get("task", ())}
    kept = {key for key, has in zip(table.keys, question.studies, strict=True) if has}
    found = {}
    for path, (studies, designs) in _paths(table).items():
        taken = tuple(key for key in studies if key in kept)
        if taken and path[0] in tasks and matching[designs].any():
            found[path] = taken
    levels = GROUPED_LEVELS if grouped else PATH_LEVELS
    nodes, links = _drawn(found, table.facts, levels, counting)
    return AnswerFlow(levels, found, nodes, links, _left_out(table.facts))


@lru_cache(maxsize=4)
def _paths(table: DesignTable) -> Mapping[Path, tuple[tuple[str, ...], list[int]]]:
    """Return the studies of every path, and the positions of the designs that it leads to."""
    facts = table.facts
    took: dict[Path, list[str]] = {}
    for key, study in facts.studies.items():
        for path in _paths_of(study):
            took.setdefault(path, []).append(key)
    order = _order(facts)
    by_parts: dict[tuple[str, str, str], list[int]] = {}
    for at, design in enumerate(table.designs):
        by_parts.setdefault((*design.architecture, design.extractor), []).append(at)
    found = {}
    for path in sorted(took, key=lambda one: [order[i][v] for i, v in enumerate(one)]):
        _, detector, mask, model, extractor = path
        kinds = set(facts.taxonomy.kinds("model", model))
        leads_to = [
            at
            for at in by_parts.get((detector, mask, extractor), ())
            if not kinds.isdisjoint(table.designs[at].stages)
        ]
        found[path] = tuple(took[path]), leads_to
    return found


def _order(facts: Facts) -> list[dict[str, int]]:
    return [{v: i for i, v in enumerate(facts.taxonomy.values(level))} for level in PATH_LEVELS]


def _paths_of(study: Study) -> Iterator[Path]:
    for path in itertools.product(*(study.has_value(level) for level in PATH_LEVELS)):
        if study.has_sensor(dict(zip(PATH_LEVELS, path, strict=True))):
            yield path


def _drawn(
    paths: Mapping[Path, tuple[str, ...]], facts: Facts, levels: Path, counting: Counting
) -> tuple[tuple[Node, ...], tuple[Link, ...]]:
    """Return nodes and links of paths in chart order, a study shared out over its paths."""
    took: dict[str, dict[Path, None]] = {}
    for path, studies in paths.items():
        shown = tuple(map(facts.taxonomy.derived_values, levels, path))
        for study in studies:
            took.setdefault(study, {})[shown] = None
    on_node: dict[tuple[int, str], dict[str, Fraction]] = {}
    on_link: dict[tuple[int, str, str], dict[str, Fraction]] = {}
    for study in sorted(took):
        share = Fraction(1, len(took[study]))
        for path in took[study]:
            for at, value in enumerate(path):
                weights = on_node.setdefault((at, value), {})
                weights[study] = weights.get(study, Fraction()) + share
            for at, pair in enumerate(itertools.pairwise(path)):
                weights = on_link.setdefault((at, *pair), {})
                weights[study] = weights.get(study, Fraction()) + share
    return drawn(levels, on_node, on_link, facts.taxonomy, counting)


def _left_out(facts: Facts) -> tuple[LeftOut, ...]:
    """Return the studies that are on no path as a value is unknown, by level."""
    found = {
        level: tuple(key for key, study in facts.studies.items() if not study.of(level))
        for level in PATH_LEVELS
    }
    return tuple(LeftOut(level, keys) for level, keys in found.items() if keys)
