"""Flows count what a group-by counts, and invent no link."""

import itertools
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from registry.flows import CHARTS, Counting, Flows, chart, flows
from registry.studies import Facts
from registry.taxonomy import LEVELS, InvalidValueError, attribute_of

VALUES = {
    "task": ["Accuracy", "Cost", "FOV"],
    "error": ["Optical", "Alignment"],
    "accuracy": ["FSS", "CSS"],
    "detector": ["CMOS", "PD"],
    "mask": ["Slit", "Lens", "Encoded"],
    "model": ["SPM", "LSQ", "ACM", "ECM", "ECM/Noise", "None"],
    "extractor": ["BCTM", "Direct"],
}
Rows = list[Mapping[str, list[str]]]
rows = st.lists(
    st.fixed_dictionaries(
        {a: st.lists(st.sampled_from(v), max_size=3, unique=True) for a, v in VALUES.items()}
    ),
    max_size=6,
)
chains = st.lists(st.sampled_from(LEVELS), min_size=2, max_size=5, unique=True)
filters = st.dictionaries(st.sampled_from(list(VALUES)), st.none(), max_size=2).flatmap(
    lambda asked: st.fixed_dictionaries(
        {a: st.lists(st.sampled_from(VALUES[a]), min_size=1, unique=True) for a in asked}
    )
)


def recount(facts: Facts, levels: Sequence[str]) -> pd.DataFrame:
    """A row for every study and combination of its values at `levels`: joins, one an attribute."""
    frame = pd.DataFrame({"study": list(facts.studies)}, dtype=object)
    for attribute in dict.fromkeys(attribute_of(level) for level in levels):
        long = pd.DataFrame(
            [(k, v) for k, s in facts.studies.items() for v in s.of(attribute)],
            columns=["study", f"of {attribute}"],
            dtype=object,
        )
        frame = frame.merge(long, how="left", on="study")
    if {"of detector", "of mask"} <= set(frame.columns):
        crossed = [
            bool(facts.studies[study].combinations)
            and (detector, mask) not in facts.studies[study].combinations
            for study, detector, mask in zip(
                frame["study"], frame["of detector"], frame["of mask"], strict=True
            )
        ]
        frame = frame[~pd.Series(crossed, index=frame.index, dtype=bool)]
    for level in levels:
        frame[level] = [
            None if pd.isna(v) else facts.taxonomy.derived_values(level, v)
            for v in frame[f"of {attribute_of(level)}"]
        ]
    return frame[["study", *levels]].drop_duplicates()


def links_by_studies(found: Flows) -> dict[tuple[str, str], set[str]]:
    return {(link.source, link.target): set(link.studies) for link in found.links}


def expected_links(frame: pd.DataFrame, levels: Sequence[str]) -> dict[tuple[str, str], set[str]]:
    expected: dict[tuple[str, str], set[str]] = {}
    for left, right in itertools.pairwise(levels):
        for (a, b), group in frame.dropna(subset=[left, right]).groupby([left, right]):
            expected[f"{left}:{a}", f"{right}:{b}"] = set(group["study"])
    return expected


@pytest.mark.parametrize("name", CHARTS)
def test_charts_count_the_studies_a_group_by_counts(survey: Facts, name: str) -> None:
    found = chart(name, facts=survey)
    frame = recount(survey, found.levels)
    assert links_by_studies(found) == expected_links(frame, found.levels)
    assert all(link.value == len(set(link.studies)) for link in found.links)
    nodes = {(n.level, n.value): n.count for n in found.nodes}
    assert nodes == {
        (level, value): count
        for level in found.levels
        for value, count in frame.groupby(level)["study"].nunique().items()
    }
    for level in found.levels:
        missing = {s.key for s in survey.studies.values() if not s.of(attribute_of(level))}
        assert {
            k for left in found.left_out if left.level == level for k in left.studies
        } == missing


@settings(deadline=None, derandomize=True, max_examples=80)
@given(table=rows, levels=chains)
def test_any_chain_counts_the_studies_a_group_by_counts(
    facts_of: Callable[[Rows], Facts], table: Rows, levels: list[str]
) -> None:
    facts = facts_of(table)
    found = flows(levels, facts=facts)
    assert links_by_studies(found) == expected_links(recount(facts, levels), levels)


@settings(deadline=None, derandomize=True, max_examples=150)
@given(table=rows, levels=chains, where=filters)
def test_fractional_inflow_equals_outflow_and_nothing_is_lost(
    facts_of: Callable[[Rows], Facts],
    table: Rows,
    levels: list[str],
    where: Mapping[str, list[str]],
) -> None:
    facts = facts_of(table)
    found = flows(levels, where, "fractional", facts)
    inflow: defaultdict[str, float] = defaultdict(float)
    outflow: defaultdict[str, float] = defaultdict(float)
    for link in found.links:
        outflow[link.source] += link.value
        inflow[link.target] += link.value
    for node in found.nodes:
        if node.level != levels[0]:
            assert inflow[node.id] == pytest.approx(node.count)
        if node.level != levels[-1]:
            assert outflow[node.id] == pytest.approx(node.count)
    left_out = {key for left in found.left_out for key in left.studies}
    for level in levels:
        weight = sum(node.count for node in found.nodes if node.level == level)
        assert weight == pytest.approx(len(set(found.studies) - left_out))


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, levels=chains)
def test_fractional_weights_split_a_study_evenly_over_its_combinations(
    facts_of: Callable[[Rows], Facts], table: Rows, levels: list[str]
) -> None:
    facts = facts_of(table)
    whole = recount(facts, levels).groupby("study").filter(lambda g: bool(g.notna().all(axis=None)))
    frame = whole.assign(weight=1 / whole.groupby("study")["study"].transform("size"))
    expected = {
        (f"{left}:{a}", f"{right}:{b}"): weight
        for left, right in itertools.pairwise(levels)
        for (a, b), weight in frame.groupby([left, right])["weight"].sum().items()
    }
    found = flows(levels, counting="fractional", facts=facts)
    assert {(link.source, link.target): link.value for link in found.links} == pytest.approx(
        expected
    )


@settings(deadline=None, derandomize=True, max_examples=100)
@given(table=rows, where=filters)
def test_a_filter_keeps_the_studies_that_have_one_of_the_values_everywhere(
    facts_of: Callable[[Rows], Facts], table: Rows, where: Mapping[str, list[str]]
) -> None:
    facts = facts_of(table)
    wanted = {
        a: {k for v in values for k in ({v, "ECM/Noise"} if v == "ECM" else {v})}
        for a, values in where.items()
    }
    expected = [
        key
        for key, study in facts.studies.items()
        if all(wanted[a] & set(study.of(a)) for a in wanted)
    ]
    found = flows(["task", "detector", "model"], where, facts=facts)
    assert list(found.studies) == expected
    for node in found.nodes:
        assert node.level not in wanted or node.value in wanted[node.level]


def test_the_sunburst_puts_each_model_in_its_category_and_ring(survey: Facts) -> None:
    found = chart("model-sunburst", facts=survey)
    links = {(link.source, link.target) for link in found.links}
    # The physics-informed models are the only ones described as calibrated online.
    assert {a for a, b in links if b == "calibration:online"} == {"model_category:Physics-Informed"}
    assert ("calibration:online", "model:ACM") in links
    assert ("calibration:offline", "model:ACM") not in links
    assert ("calibration:offline", "model:SPM") in links
    assert found.left_out == ()


@pytest.mark.parametrize(
    ("levels", "where", "counting", "message"),
    [
        (["task", "detectr"], {}, "studies", "did you mean 'detector'"),
        (["task", "mask"], {"mask": "Slits"}, "studies", "did you mean 'Slit'"),
        (["task", "mask"], {"masks": "Slit"}, "studies", "did you mean 'mask'"),
        (["task", "mask"], {}, "study", "did you mean 'studies'"),
        (["task"], {}, "studies", "two or more"),
        (["task", "task"], {}, "studies", "two or more"),
    ],
)
def test_wrong_questions_name_what_was_expected(
    levels: list[str], where: dict[str, str], counting: Counting, message: str
) -> None:
    with pytest.raises(InvalidValueError, match=message):
        flows(levels, where, counting)


def test_an_unknown_chart_names_the_nearest() -> None:
    with pytest.raises(InvalidValueError, match="did you mean 'performance'"):
        chart("perfomance")
