"""Parts of pages at their edges: nothing to draw, no formula after all, words of no list."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from api.pages.algorithm import SWEPT, _sweep
from api.pages.formulas import tex
from api.pages.methods import docstring_parts, mark_up
from api.pages.plots.scatter import Point, Scatter
from api.pages.search import page_of
from api.service.index.index import Entry
from survey_data import labels


@pytest.mark.parametrize(
    "text", ["f()", "a + ()", "x_{}(", "a^(2)", "a^+", "a^", "x_", "x_ y", "x_(a", "(a]", "|a"]
)
def test_a_formula_that_ends_or_opens_nothing_is_none(text: str) -> None:
    assert tex(text) is None


@pytest.mark.parametrize("text", ["f(a)", "a + (b)", "x_{a}", "a^2", "a^-b", "x_(a)", "|a|"])
def test_the_same_with_its_end_is_a_formula(text: str) -> None:
    assert tex(text) is not None


def test_a_label_in_backquotes_is_told_by_its_name_and_other_code_stays() -> None:
    label, name = "alg:BCM", labels.name("alg:BCM")
    assert label in labels.labels()
    assert mark_up(f"by `{label}` and `bcm`") == (
        f'by <span title="{label}">{name}</span> and <code>bcm</code>'
    )


class Documented:
    """Lead.

    Parameters
    ----------
        indented before any name
    first : int
        What it is,
        and more.
    second
    """

    about = SimpleNamespace(name="documented")


def test_parameters_of_a_docstring_begin_with_the_first_name() -> None:
    (said,) = docstring_parts(Documented)
    assert [(name, kind, str(text)) for name, kind, text in said.parameters] == [
        ("first", "int", "What it is, and more."),
        ("second", "", ""),
    ]


@pytest.mark.parametrize(
    ("kind", "identifier", "address"),
    [
        ("study", "Liebe2001", "/studies/Liebe2001"),
        ("attribute", "detector: CMOS", "/detectors/CMOS"),
        ("attribute", "detector", "/glossary#attribute-detector"),
        ("word", "no such word", "/glossary"),
    ],
)
def test_what_is_found_leads_to_its_page_or_its_place_in_the_glossary(
    kind: str, identifier: str, address: str
) -> None:
    assert page_of(Entry(kind, identifier, "title")) == address


def test_a_point_without_a_bound_has_no_stem_and_no_points_make_no_line() -> None:
    points = [
        Point("a", "/a", 10.0, 0.1, 0.05),
        Point("b", "/b", 20.0, 0.2, None),
    ]
    drawn = Scatter(points, "field", more_is_better=True, unit="°").__html__()
    assert drawn.count('class="stem"') == 1
    assert drawn.count(", bound ") == 1
    assert drawn.count('class="front"') == 1
    empty = Scatter([], "field", more_is_better=True).__html__()
    assert "Own error of 0 architectures" in empty
    assert 'class="front"' not in empty


def test_a_sweep_of_which_nothing_is_known_is_not_drawn() -> None:
    row = {"extractor": "e", "sweep": SWEPT[0][0], "unit": "px", "value": 0.1}
    rows = [
        {**row, "series": "one", "rms": None, "bound": None},
        {**row, "series": "two", "rms": 0.2, "bound": 0.1},
    ]
    known: Any = SimpleNamespace(measurements=SimpleNamespace(sweeps=rows))
    assert [series for _, _, series in _sweep(known, "e")] == ["two"]
