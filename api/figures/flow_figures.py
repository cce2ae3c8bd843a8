"""The Sankey diagrams: error, performance, cross-analysis, its aggregate, and task."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from api.figures import wording
from api.figures.addresses import Addresses
from api.figures.figure import Figure, in_words
from api.figures.sankey import Band, Stage, sankey
from api.figures.specification import Plotly, colour, mark
from api.schema.figures import FlowRow
from api.schema.table import columns_of
from registry.answer import Answer
from registry.flows import Counting, Flows, Node, Where, flows
from registry.paths import answer_flow
from registry.studies import Facts
from registry.taxonomy import Taxonomy


@dataclass(frozen=True)
class Chain:
    """A Sankey diagram of the survey: its levels from left to right."""

    title: str
    levels: tuple[str, ...]
    caption: str


CHAINS: Mapping[str, Chain] = MappingProxyType(
    {
        "error": Chain(
            "Errors",
            ("error", "detector", "mask"),
            "Which sources of error are addressed on which detector, behind which mask.",
        ),
        "performance": Chain(
            "Performance",
            ("accuracy", "mask", "model_category"),
            "Which masks and kinds of calibration model reach which class of accuracy.",
        ),
        "cross-analysis": Chain(
            "Cross-analysis",
            ("task", "detector", "mask", "model", "extractor"),
            "From what a study wants to improve, through its sensor, to its calibration.",
        ),
        "task": Chain(
            "Tasks", ("task", "detector", "mask"), "Which sensors studies build for which task."
        ),
        "aggregate": Chain(
            "Cross-analysis, aggregated",
            ("task", "detector", "mask", "model_category", "extractor_family"),
            "The cross-analysis with models and extractors by their families.",
        ),
    }
)
"""The survey's errorsankey, perfsankey and casankey, and the two that its Tableau page adds."""

_PINNED = ("accuracy",)  # from coarse to ultra fine, whatever crosses


def flow_figure(
    name: str, facts: Facts, addresses: Addresses, where: Where, counting: Counting = "studies"
) -> Figure:
    """Return a Sankey diagram of the studies that meet `where`.

    Parameters
    ----------
    name : of `CHAINS`
    facts : the studies
    addresses : where marks lead
    where, counting : as `registry.flows.flows` takes them

    Raises
    ------
    InvalidValueError
        As `registry.flows.flows`.
    """
    chain = CHAINS[name]
    found = flows(chain.levels, where, counting, facts=facts)
    return _figure(name, chain, found, facts, addresses)


def answer_figure(
    answer: Answer, facts: Facts, page: str, counting: Counting = "studies", *, grouped: bool = True
) -> Figure:
    """Return a Sankey diagram of the studies behind an answer.

    Parameters
    ----------
    answer, counting, grouped : as `registry.paths.answer_flow` takes them
    facts : the studies
    page : address of the answer, with its query
    """
    made = answer_flow(answer, counting, grouped=grouped)
    keys = tuple(sorted({key for node in made.nodes for key in node.studies}))
    found = Flows(None, made.levels, counting, keys, made.nodes, made.links, made.left_out)
    chain = Chain("Decision flow", made.levels, "From task to feature extractor.")
    return _figure("flow", chain, found, facts, Addresses(facts, page, {}))


def _figure(name: str, chain: Chain, found: Flows, facts: Facts, addresses: Addresses) -> Figure:
    nodes = {node.id: node for node in found.nodes}
    rows = [
        *(_row(node, None, node.studies, node.count) for node in found.nodes),
        *(_row(nodes[x.source], nodes[x.target], x.studies, x.value) for x in found.links),
    ]
    return Figure(
        name=name,
        title=chain.title,
        caption=chain.caption,
        text=_text(found, facts),
        columns=columns_of(FlowRow),
        rows=tuple(rows),
        plotly=_plotly(found, facts.taxonomy, addresses),
        studies=len(found.studies),
        left_out=found.left_out,
    )


def _plotly(found: Flows, taxonomy: Taxonomy, addresses: Addresses) -> Plotly:
    """Return a flow as a Sankey diagram; its rows are the nodes, then the links."""
    stages: list[Stage] = []
    for at, node in enumerate(found.nodes):
        said = wording.value_label(taxonomy, node.level, node.value)
        title = f"{wording.LEVELS[node.level]} {said}: {wording.studies(node.count)}"
        href = addresses.of(node.studies, {node.level: node.value}, at)
        shown = wording.display_name(node.level, node.value)
        stages.append(
            Stage(
                id=node.id,
                column=found.levels.index(node.level),
                label=f"{shown}  {wording.amount(node.count)}",
                colour=colour(taxonomy.values(node.level).index(node.value)),
                mark=mark(
                    title,
                    href,
                    studies=node.studies,
                    narrow=addresses.implied(node.level, node.value),
                ),
            )
        )
    nodes = {node.id: node for node in found.nodes}
    bands: list[Band] = []
    for at, link in enumerate(found.links, len(found.nodes)):
        ends = [nodes[link.source], nodes[link.target]]
        names = " → ".join(wording.display_name(end.level, end.value) for end in ends)
        given = {end.level: end.value for end in ends}
        narrow = {k: v for end in ends for k, v in addresses.implied(end.level, end.value).items()}
        bands.append(
            Band(
                link.source,
                link.target,
                link.value,
                mark(
                    f"{names}: {wording.studies(link.value)}",
                    addresses.of(link.studies, given, at),
                    studies=link.studies,
                    narrow=narrow,
                ),
            )
        )
    pinned = [at for at, level in enumerate(found.levels) if level in _PINNED]
    return sankey(stages, bands, [wording.LEVELS[level] for level in found.levels], pinned)


def _row(
    node: Node, target: Node | None, studies: tuple[str, ...], count: float
) -> dict[str, object]:
    """Return a row of the table: of a value, or of a flow from it to a value of the next level."""
    return {
        "level": node.level,
        "value": node.value,
        "name": node.name,
        "next_level": "" if target is None else target.level,
        "next_value": "" if target is None else target.value,
        "next_name": "" if target is None else target.name,
        "count": count,
        "studies": list(studies),
    }


def _text(found: Flows, facts: Facts) -> tuple[str, ...]:
    """Return the most frequent value of each level and the widest flow between each two."""
    heads = [wording.LEVELS[level].lower() for level in found.levels]
    total = wording.studies(len(found.studies))
    wide = "a band is as wide as the studies that have both values"
    said = [f"Flow of {total} through {wording.join_words(heads)}, left to right; {wide}."]
    for level in found.levels:
        nodes = [node for node in found.nodes if node.level == level]
        if nodes:
            most = max(nodes, key=lambda node: node.count)
            value = wording.value_label(facts.taxonomy, level, most.value)
            among = wording.plural(len(nodes), "value")
            said.append(
                f"Most frequent {wording.LEVELS[level].lower()}: {value}, "
                f"{wording.studies(most.count)}, among {among}."
            )
    values = {node.id: node for node in found.nodes}
    for level in found.levels[:-1]:
        links = [link for link in found.links if values[link.source].level == level]
        if links:
            widest = max(links, key=lambda link: link.value)
            ends = [
                wording.display_name(values[end].level, values[end].value)
                for end in (widest.source, widest.target)
            ]
            said.append(
                f"Widest flow from {wording.LEVELS[level].lower()}: {ends[0]} to {ends[1]}, "
                f"{wording.studies(widest.value)}."
            )
    missing = in_words(found.left_out, wording.LEVELS)
    return (*said, missing) if missing else tuple(said)
