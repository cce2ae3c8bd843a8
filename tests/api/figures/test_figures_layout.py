"""No node, label or bar of any figure overlaps another, at any width, for any flow."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from api.figures import svg
from api.figures.catalogue import TITLES, evidence_map, figure
from api.figures.lettering import text_width, wrap
from api.figures.ordering import crossings, order
from api.figures.sankey_layout import sankey_layout
from api.figures.sankey_svg import Mark, SankeyMarks, draw_sankey
from api.figures.sunburst_svg import Sector, draw_sunburst
from api.figures.svg import Drawing
from registry.studies import facts
from tests.api.figures.geometry import outside, overlaps, shapes, width_of

WIDTHS = (322.0, 390.0, 501.0, 680.0, 820.0, 960.0, 1100.0, 1240.0)
PAIRS = [
    ("detector", "mask"),
    ("model", "extractor"),
    pytest.param("extractor", "model", marks=pytest.mark.slow),
    ("task", "accuracy"),
    ("model_category", "model"),
    ("mask", "mask"),
]


def test_the_oracle_sees_what_overlaps_and_what_reaches_out() -> None:
    def drawn(*parts: str) -> Drawing:
        return Drawing(100, 60, "".join(parts))

    first = svg.text(10, 20, "CCD 18")
    assert overlaps(drawn(first, svg.text(40, 28, "CMOS 48"))) == [("CCD 18", "CMOS 48")]
    assert overlaps(drawn(first, svg.text(10, 36, "CMOS 48"))) == []
    assert overlaps(drawn(first, svg.rectangle(30, 5, 9, 50, "node"))) == [("CCD 18", "node")]
    # Boxes around the two texts meet; the texts themselves, both turned, do not.
    turned = [svg.text(x, 10, "Single", anchor="start", turned=45) for x in (10, 40)]
    assert overlaps(drawn(*turned)) == []
    assert outside(drawn(svg.text(80, 20, "CMOS 48"))) == ["CMOS 48"]


@pytest.mark.parametrize("name", TITLES)
@pytest.mark.parametrize(
    "width",
    [
        pytest.param(wide, marks=() if wide in {322.0, 680.0, 1240.0} else pytest.mark.slow)
        for wide in WIDTHS
    ],
)
def test_nothing_overlaps_in_a_figure_of_the_survey(name: str, width: float) -> None:
    drawing = figure(name, facts()).draw(width)
    assert len([s for s in shapes(drawing) if s.kind == "text"]) > 10
    assert overlaps(drawing) == []
    assert outside(drawing) == []


@pytest.mark.parametrize(("rows", "columns"), PAIRS)
@pytest.mark.parametrize(
    "width", [322.0, *[pytest.param(wide, marks=pytest.mark.slow) for wide in (680.0, 1100.0)]]
)
def test_nothing_overlaps_in_a_matrix(rows: str, columns: str, width: float) -> None:
    drawing = evidence_map(facts(), {}, rows, columns).draw(width)
    assert overlaps(drawing) == []
    assert outside(drawing) == []


WORD = st.text("abcdefgimwABCMW/-.0189", min_size=1, max_size=12)
NAME = st.lists(WORD, min_size=1, max_size=4).map(" ".join)


@st.composite
def flow(draw: st.DrawFn) -> SankeyMarks:
    """Any columns of nodes, any links between neighbouring columns, any names."""
    sizes = draw(st.lists(st.integers(1, 9), min_size=2, max_size=5))
    columns = [[f"{at}:{node}" for node in range(size)] for at, size in enumerate(sizes)]
    possible = [
        pair for one, other in itertools.pairwise(columns) for pair in itertools.product(one, other)
    ]
    values = draw(
        st.dictionaries(st.sampled_from(possible), st.integers(1, 60), min_size=1, max_size=40)
    )
    nodes = [node for column in columns for node in column]
    labels = {node: (draw(NAME), str(draw(st.integers(1, 999)))) for node in nodes}
    mark = Mark("title", "/studies")
    return SankeyMarks(
        columns=columns,
        values=values,
        labels=labels,
        colours=dict.fromkeys(nodes, 1),
        headings=[draw(NAME) for _ in columns],
        pinned=(),
        nodes=dict.fromkeys(nodes, mark),
        bands=dict.fromkeys(values, mark),
    )


@given(marks=flow(), width=st.sampled_from(WIDTHS))
@settings(max_examples=60)
def test_nothing_overlaps_in_any_flow(marks: SankeyMarks, width: float) -> None:
    drawing = draw_sankey(marks, width)
    assert overlaps(drawing) == []
    assert outside(drawing) == []


@given(marks=flow(), width=st.sampled_from(WIDTHS))
@settings(max_examples=60)
def test_bands_fill_no_more_than_their_nodes_and_keep_to_their_proportion(
    marks: SankeyMarks, width: float
) -> None:
    laid = sankey_layout(
        marks.columns, marks.values, marks.labels, marks.headings, width=width, flow_height=300
    )
    drawn = [(link.source, link.target) for link in laid.links]
    assert sorted(drawn) == sorted(marks.values), "every link once, whatever the panels"
    scale = {link.width / marks.values[link.source, link.target] for link in laid.links}
    assert max(scale) == pytest.approx(min(scale))
    for node in laid.nodes:
        for side, ends in (("source", "y0"), ("target", "y1")):
            touching = [
                link
                for link in laid.links
                if getattr(link, side) == node.id
                and abs((link.x0 if side == "source" else link.x1) - node.x) < 13
            ]
            spans = sorted(
                (getattr(link, ends) - link.width / 2, getattr(link, ends) + link.width / 2)
                for link in touching
            )
            for (_, low), (high, _) in itertools.pairwise(spans):
                assert high >= low - 1e-6
            if spans:
                assert spans[0][0] >= node.y - 1e-6
                assert spans[-1][1] <= node.y + node.height + 1e-6


@given(marks=flow())
def test_ordering_keeps_the_nodes_and_never_crosses_more(marks: SankeyMarks) -> None:
    found = order(marks.columns, marks.values)
    assert [sorted(column) for column in found] == [sorted(column) for column in marks.columns]
    assert crossings(found, marks.values) <= crossings(marks.columns, marks.values)


def sector(size: int, name: str, inside: tuple[Sector, ...] = ()) -> Sector:
    return Sector(name, f"{name} in full", size, size, 1, name, "/studies", inside)


@given(
    trees=st.lists(
        st.tuples(NAME, st.lists(st.tuples(NAME, st.integers(1, 40)), min_size=1, max_size=9)),
        min_size=1,
        max_size=7,
    ),
    width=st.sampled_from(WIDTHS),
)
@settings(max_examples=60)
def test_nothing_overlaps_in_any_sunburst(
    trees: list[tuple[str, list[tuple[str, int]]]], width: float
) -> None:
    sectors = []
    for name, leaves in trees:
        total = sum(size for _, size in leaves)
        ring = sector(total, "offline", tuple(sector(size, leaf) for leaf, size in leaves))
        sectors.append(sector(total, name, (ring,)))
    drawing = draw_sunburst(sectors, width)
    assert overlaps(drawing) == []
    assert outside(drawing) == []


@given(text=NAME, size=st.sampled_from([12.0, 13.0]), bold=st.booleans())
def test_text_is_never_wider_than_said(text: str, size: float, bold: bool) -> None:
    assert width_of(text, size, bold) <= text_width(text, size, bold=bold) + 0.05


@given(text=NAME, width=st.floats(20, 300), most=st.integers(1, 3))
def test_wrapped_text_keeps_to_its_width_and_loses_nothing_silently(
    text: str, width: float, most: int
) -> None:
    lines = wrap(text, width, 12.0, most)
    assert len(lines) <= most
    assert all(text_width(line, 12.0) <= width for line in lines)
    said = " ".join(lines)
    assert said == " ".join(text.split()) or "…" in said
