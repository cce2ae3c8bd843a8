"""Every figure by its name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Annotated

from api.figures import evidence_matrix, publication_bars, sensor_lines, sunburst
from api.figures.addresses import Addresses
from api.figures.evidence_matrix import matrix_figure
from api.figures.figure import Figure
from api.figures.flow_figures import CHAINS, flow_figure
from api.figures.publication_bars import publications_figure
from api.figures.sensor_lines import coordinates_figure
from api.figures.sunburst import sunburst_figure
from api.schema.figures import COLUMNS, ROWS
from api.schema.parameters import OneOf
from registry.catalogue import catalogue
from registry.evidence import Evidence
from registry.flows import Counting, Where
from registry.studies import Facts
from registry.taxonomy import unknown_name

_OTHERS = {
    sunburst.NAME: (sunburst_figure, sunburst.TITLE, sunburst.CAPTION),
    publication_bars.NAME: (publications_figure, publication_bars.TITLE, publication_bars.CAPTION),
    sensor_lines.NAME: (coordinates_figure, sensor_lines.TITLE, sensor_lines.CAPTION),
}
MATRIX = evidence_matrix.NAME

TITLES: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        **{name: (chain.title, chain.caption) for name, chain in CHAINS.items()},
        **{name: (title, caption) for name, (_, title, caption) in _OTHERS.items()},
    }
)
"""The survey's figures: name -> title and caption."""
FigureName = Annotated[str, OneOf(lambda: tuple(TITLES))]

LEVELS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **{name: chain.levels for name, chain in CHAINS.items()},
        sunburst.NAME: sunburst.LEVELS,
        publication_bars.NAME: ("year",),
        sensor_lines.NAME: ("year", "detector", "mask", "accuracy"),
    }
)
"""What each figure shows of a study."""


def figure(
    name: str,
    facts: Facts,
    where: Where | None = None,
    page: str | None = None,
    counting: Counting = "studies",
) -> Figure:
    """Return one of the survey's figures.

    Parameters
    ----------
    name : of `TITLES`
    facts : the studies
    where : keeps some of them, as `registry.flows.flows` does
    page : address of the figure's page, with its query; where rows of its table are linked to
    counting : of flows, as `registry.flows.flows` counts

    Raises
    ------
    InvalidValueError
        For a name, a level or a value that is not known.
    """
    if name not in TITLES:
        raise unknown_name("figure", name, TITLES)
    wanted = where or {}
    addresses = Addresses(facts, page or f"/figures/{name}", wanted)
    if name in CHAINS:
        return flow_figure(name, facts, addresses, wanted, counting)
    return _OTHERS[name][0](facts, addresses, wanted)


def evidence_map(
    facts: Facts,
    where: Where | None = None,
    rows: str = ROWS,
    columns: str = COLUMNS,
    page: str | None = None,
    *,
    evidence: Evidence | None = None,
) -> Figure:
    """Return the matrix of studies by two attributes or levels; raises as `matrix_figure`.

    Without `evidence` nothing counts as measured.
    """
    wanted = where or {}
    addresses = Addresses(facts, page or f"/figures/{evidence_matrix.NAME}", wanted)
    known = Evidence(catalogue(), (), {}) if evidence is None else evidence
    return matrix_figure(facts, addresses, wanted, known, rows=rows, columns=columns)
