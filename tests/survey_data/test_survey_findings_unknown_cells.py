"""Verdicts against every way in which unknown cells of small tables could be filled."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from typing import Any

import pandas as pd
from hypothesis import given, settings
from hypothesis import strategies as st

from survey_data.findings.checks import evaluate, study_values
from survey_data.findings.grammar import Vocabulary

VALUES = {
    "accuracy": ("fine", "coarse"),  # one a study at most
    "task": ("t", "u"),
    "error": ("A", "B", "C"),
    "detector": ("PD", "QPD"),
    "mask": ("m", "n"),
    "model": ("p", "q", "r"),
    "extractor": ("X", "Y", "Z"),
}
CATEGORIES = {"p": "P", "q": "P", "r": "R", "X": "Centroid detection", "Y": "Centroid detection"}
TAXONOMY = pd.DataFrame(
    [(a, v, v, CATEGORIES.get(v, "other")) for a, values in VALUES.items() for v in values],
    columns=["attribute", "value", "name", "category"],
)
VOCABULARY = Vocabulary(TAXONOMY, {"accuracy"})
NO_SENSORS = pd.DataFrame([], columns=["study", "detector", "mask"])
CLAUSES = [
    ("accuracy=fine", "error: A", "top"),
    ("accuracy=fine", "error: A|B", "top"),
    ("accuracy=fine", "error: A|B", "top-set"),
    (None, "error: A|B", "top-set"),
    (None, "error: A>B", "order"),
    (None, "error: C", "bottom"),
    ("task=t", "error: B|C", "bottom-set"),
    (None, "error: A|C", "among"),
    (None, "error: A|B", "no-majority"),
    (None, "error: A or B|C", "top-set"),
    (None, "accuracy: coarse>fine", "order"),
    ("error=A", "detector+mask: PD+m", "top"),
    ("detector=PD", "detector+mask: PD+m|PD+n", "top-set"),
    (None, "detector+mask: PD+m or QPD+m", "top"),
    ("task=t", "model_category: R", "top"),
    (None, "extractor: Y", "top-centroid"),
    ("accuracy=fine&task=t", "mask: n", "top"),
]
Cells = dict[str, dict[str, tuple[str, ...] | None]]


def relevant(given_: str | None, expects: str) -> list[str]:
    """Attributes that a clause looks at."""
    names = {part.partition("=")[0] for part in (given_ or "").split("&") if part}
    ranked = expects.partition(":")[0]
    base = {"model_category": "model", "extractor_family": "extractor"}
    return sorted(names | {base.get(part, part) for part in ranked.split("+")})


def fillings(attribute: str) -> list[tuple[str, ...]]:
    """Every value or set of values that a cell could hold."""
    values = VALUES[attribute]
    most = 1 if attribute == "accuracy" else len(values)
    return [some for n in range(1, most + 1) for some in itertools.combinations(values, n)]


def judged(cells: Cells, clause: tuple[str | None, str, str]) -> Any:
    studies = pd.DataFrame({"key": list(cells), "year": 2001})
    rows = [(s, a, v) for s, of in cells.items() for a, held in of.items() for v in held or ()]
    attributes = pd.DataFrame(rows, columns=["study", "attribute", "value"])
    values = study_values(studies, attributes, NO_SENSORS, VOCABULARY)
    names = dict(zip(("given", "expects", "kind"), clause, strict=True))
    return evaluate({"clause": 1, "statement": "made up", **names}, values, VOCABULARY)


def completed(cells: Cells, unknown: list[tuple[str, str]]) -> Iterator[tuple[int, Cells]]:
    """Yield tables with some of the unknown cells filled, and in how many studies."""
    choices = [[None, *fillings(attribute)] for _, attribute in unknown]
    for chosen in itertools.product(*choices):
        filled = {study: dict(of) for study, of in cells.items()}
        for (study, attribute), value in zip(unknown, chosen, strict=True):
            filled[study][attribute] = value
        known = zip(unknown, chosen, strict=True)
        yield len({study for (study, _), value in known if value is not None}), filled


@st.composite
def tables(draw: st.DrawFn) -> tuple[Cells, list[tuple[str, str]], tuple[str | None, str, str]]:
    """Six studies of which up to two cells that the clause looks at are unknown."""
    clause = draw(st.sampled_from(CLAUSES))
    names = relevant(clause[0], clause[1])
    cells: Cells = {
        f"s{n}": {name: draw(st.sampled_from(fillings(name))) for name in names} for n in range(6)
    }
    places = [(study, name) for study in cells for name in names]
    unknown = draw(st.lists(st.sampled_from(places), min_size=1, max_size=2, unique=True))
    for study, name in unknown:
        cells[study][name] = None
    return cells, unknown, clause


@settings(max_examples=60, deadline=None)
@given(tables())
def test_a_clause_is_contradicted_only_where_no_filling_makes_it_hold(drawn: Any) -> None:
    cells, unknown, clause = drawn
    found = judged(cells, clause)
    if found.verdict == "reproduced" or found.counted < 3:
        return
    turned = [
        studies
        for studies, filled in completed(cells, unknown)
        if judged_by_known_cells(filled, clause)
    ]
    assert (found.verdict == "undecidable") == bool(turned)
    if turned:
        (said,) = re.findall(r"unknown cells of (\d+) stud(?:y|ies) could", found.settled_by)
        assert int(said) == min(turned)


def judged_by_known_cells(cells: Cells, clause: tuple[str | None, str, str]) -> bool:
    return bool(judged(cells, clause).verdict == "reproduced")
