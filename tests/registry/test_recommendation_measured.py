"""Recommendations where something was measured: limits, ranks and trade-offs case by case."""

import math
from collections.abc import Callable, Mapping

import pytest

from registry import paths
from registry.measured import Measured, Measurements
from registry.recommendation import recommend
from registry.studies import Facts

Rows = list[Mapping[str, list[str]]]
PATH = {
    "task": ["Cost"],
    "detector": ["CMOS"],
    "mask": ["Slit"],
    "model": ["SPM"],
    "extractor": ["BCTM"],
}


def score(**changed: object) -> Measured:
    row: dict[str, object] = {
        "dataset": "d",
        "condition": "nominal",
        "detector": "CMOS",
        "mask": "Slit",
        "extractor": "bctm",
        "extractor_taxonomy": "BCTM",
        "model": "spm",
        "model_taxonomy": "SPM",
        "rms_deg": 0.1,
        "half_fov_deg": 60.0,
    }
    return Measured(**{**row, **changed})  # type: ignore[arg-type]


def one_study(facts_of: Callable[[Rows], Facts], **numbers: str) -> Facts:
    return facts_of([{**PATH, **{a: [n] for a, n in numbers.items()}}])


def test_a_measurement_outranks_what_the_study_states(facts_of: Callable[[Rows], Facts]) -> None:
    facts = one_study(facts_of, accuracy_deg="0.01")
    ask = {"max_error_deg": 0.05}
    assert recommend(ask, facts=facts).paths[0].basis == {"max_error_deg": "stated"}
    assert recommend(ask, [score()], facts=facts).count == 0
    (path,) = recommend(ask, [score(rms_deg=0.04)], facts=facts).paths
    assert path.basis == {"max_error_deg": "measured"}
    assert path.measured == score(rms_deg=0.04)


def test_a_quantity_not_measured_is_judged_on_what_is_stated(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of, fov_deg="100")
    ask = {"max_error_deg": 0.2, "min_fov_deg": 90}
    (path,) = recommend(ask, [score(half_fov_deg=None)], facts=facts).paths
    assert path.basis == {"max_error_deg": "measured", "min_fov_deg": "stated"}


def test_min_fov_is_the_full_field_of_view(facts_of: Callable[[Rows], Facts]) -> None:
    facts = one_study(facts_of)
    assert recommend({"min_fov_deg": 120}, [score()], facts=facts).count == 1
    assert recommend({"min_fov_deg": 120.1}, [score()], facts=facts).count == 0


def test_the_most_accurate_row_that_meets_all_limits_is_shown(
    facts_of: Callable[[Rows], Facts],
) -> None:
    rows = [score(dataset="narrow", rms_deg=0.01, half_fov_deg=10.0), score(dataset="wide")]
    facts = one_study(facts_of)
    assert recommend({}, rows, facts=facts).paths[0].measured == rows[0]
    assert recommend({"min_fov_deg": 90}, rows, facts=facts).paths[0].measured == rows[1]


def test_failed_runs_and_numbers_that_are_none_do_not_count(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = one_study(facts_of)
    failed = [score(rms_deg=None), score(rms_deg=math.nan)]
    assert recommend({}, failed, facts=facts).paths[0].measured is None
    assert score(over_bound=math.inf).over_bound is None


def by_mask(facts_of: Callable[[Rows], Facts], *masks: str) -> Facts:
    """A study a mask, all else alike: paths of equal support."""
    return facts_of([{**PATH, "mask": [mask]} for mask in masks])


@pytest.mark.parametrize(
    ("ask", "unbeaten"),
    [
        ({}, ["Slit"]),
        ({"max_error_deg": 1.0}, ["Slit"]),
        ({"min_fov_deg": 50.0}, ["Encoded", "Lens"]),
        ({"min_fov_deg": 50.0, "max_error_deg": 1.0}, ["Slit", "Encoded"]),
        ({"max_latency_us": 50.0}, ["Lens"]),
        ({"max_latency_us": 50.0, "min_fov_deg": 50.0}, ["Lens"]),
        ({"max_latency_us": 50.0, "max_error_deg": 1.0}, ["Slit", "Encoded", "Lens"]),
    ],
)
def test_the_pareto_set_is_of_the_quantities_asked_for(
    facts_of: Callable[[Rows], Facts], ask: dict[str, float], unbeaten: list[str]
) -> None:
    """Small errors and latencies, wide fields: each path is best at something else."""
    rows = [
        score(mask="Slit", rms_deg=0.1, half_fov_deg=30.0, latency_us=40.0),
        score(mask="Encoded", rms_deg=0.2, half_fov_deg=60.0, latency_us=30.0),
        score(mask="Lens", rms_deg=0.3, half_fov_deg=60.0, latency_us=20.0),
    ]
    answer = recommend(ask, rows, facts=by_mask(facts_of, "Lens", "Encoded", "Slit"))
    assert [path.mask for path in answer.paths] == ["Slit", "Encoded", "Lens"]
    assert sorted(path.mask for path in answer.paths if path.pareto) == sorted(unbeaten)


def test_an_unmeasured_path_is_worst_but_for_its_support(
    facts_of: Callable[[Rows], Facts],
) -> None:
    rows = [score(mask="Slit")]
    facts = by_mask(facts_of, "Lens", "Slit", "Encoded")
    found = {path.mask: (path.rank, path.pareto) for path in recommend({}, rows, facts=facts).paths}
    assert found["Slit"] == (1, True)
    assert found["Lens"][1] is found["Encoded"][1] is False
    backed = by_mask(facts_of, "Lens", "Slit", "Lens")
    found = {p.mask: (p.rank, p.pareto) for p in recommend({}, rows, facts=backed).paths}
    assert found == {"Lens": (1, True), "Slit": (2, True)}


def test_equals_stand_in_the_order_of_the_taxonomy(
    survey: Facts, facts_of: Callable[[Rows], Facts]
) -> None:
    facts = by_mask(facts_of, *reversed(survey.taxonomy.values("mask")))
    answer = recommend({}, facts=facts)
    assert [path.mask for path in answer.paths] == list(survey.taxonomy.values("mask"))
    assert [node.value for node in answer.nodes if node.level == "mask"] == list(
        survey.taxonomy.values("mask")
    )
    assert [link.target for link in answer.links if link.source == "detector:CMOS"] == [
        f"mask:{mask}" for mask in survey.taxonomy.values("mask")
    ]
    levels = [node.level for node in answer.nodes]
    assert list(dict.fromkeys(levels)) == ["task", "detector", "mask", "model", "extractor"]
    (detector,) = (node for node in answer.nodes if node.level == "detector")
    assert detector.count == len(detector.studies) == len(facts.studies)
    assert detector.studies == tuple(facts.studies)


def test_what_seldom_answers_keeps_no_limit_of_error_and_ranks_behind(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts = by_mask(facts_of, "Slit", "Lens")
    silent = score(mask="Slit", rms_deg=0.001, available=False)
    rows = [silent, score(mask="Lens", rms_deg=5.0)]
    assert [path.mask for path in recommend({}, rows, facts=facts).paths] == ["Lens", "Slit"]
    assert recommend({}, [silent], facts=facts).paths[0].mask == "Slit"  # of equals the first
    answer = recommend({"max_error_deg": 6.0}, rows, facts=facts)
    assert [path.mask for path in answer.paths] == ["Lens"]
    assert recommend({"min_fov_deg": 90.0}, rows, facts=facts).count == 2
    # and beside a row that does answer, it is that one which is shown
    answering = score(mask="Slit", rms_deg=0.4)
    (path,) = recommend({}, [silent, answering], facts=by_mask(facts_of, "Slit")).paths
    assert path.measured == answering


def test_rows_of_a_route_are_best_first_and_equals_by_name() -> None:
    rows = [
        score(dataset="c", rms_deg=0.2),
        score(dataset="b", rms_deg=0.2),
        score(dataset="a", rms_deg=0.001, available=False),
        score(dataset="d", rms_deg=0.1),
        score(dataset="e", mask="Lens"),
    ]
    for order in (rows, rows[::-1]):
        found = Measurements(order).on(("CMOS", "Slit", "BCTM", "SPM"))
        assert [row.dataset for row in found] == ["d", "b", "c", "a"]
    assert Measurements(rows).on(("CMOS", "Slit", "SPM", "BCTM")) == ()


@pytest.mark.parametrize(
    ("numbers", "limit", "at", "beyond"),
    [
        ({"accuracy_deg": "0.5"}, "max_error_deg", 0.5, math.nextafter(0.5, 0)),
        ({"fov_deg": "120"}, "min_fov_deg", 120.0, math.nextafter(120.0, 200)),
    ],
)
def test_a_stated_number_keeps_a_limit_that_it_equals(
    facts_of: Callable[[Rows], Facts],
    numbers: dict[str, str],
    limit: str,
    at: float,
    beyond: float,
) -> None:
    facts = one_study(facts_of, **numbers)
    assert recommend({limit: at}, facts=facts).count == 1
    assert recommend({limit: beyond}, facts=facts).count == 0


def test_a_measured_number_keeps_a_limit_that_it_equals(
    facts_of: Callable[[Rows], Facts],
) -> None:
    facts, row = one_study(facts_of), score(rms_deg=0.25, half_fov_deg=30.0, latency_us=8.0)
    for limit, at, worse in (
        ("max_error_deg", 0.25, 0.2499),
        ("min_fov_deg", 60.0, 60.1),
        ("max_latency_us", 8.0, 7.9),
    ):
        (path,) = recommend({limit: at}, [row], facts=facts).paths
        assert path.basis == {limit: "measured"}
        assert recommend({limit: worse}, [row], facts=facts).count == 0


def test_support_is_said_to_four_decimals(facts_of: Callable[[Rows], Facts]) -> None:
    facts = facts_of([PATH, {**PATH, "extractor": ["BCM"]}, {**PATH, "model": ["LUT"]}])
    path = recommend({}, facts=facts).paths[0]
    assert path.literature.to_dict() == {
        "studies": 1, "with_model": 2, "architecture": 3, "support": 1.8171,
    }  # fmt: skip


def test_sets_and_nodes_made_once_are_kept_but_never_many(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(paths, "_MOST_KEPT", 2)
    kept: dict[str, int] = {}
    sizes = []
    for number, name in enumerate("abcde"):
        paths._keep(kept, name, number)
        assert kept[name] == number
        sizes.append(len(kept))
    assert sizes == [1, 2, 1, 2, 1]
