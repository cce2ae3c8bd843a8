"""Each task is ranked by its own measure, in an order that a person can check with a pencil."""

import math
from collections.abc import Callable
from dataclasses import replace
from statistics import median

import pytest
from scores import pipeline

from registry.designs import Place
from registry.ranking import joint_order, task_measure
from registry.recommendation import recommend
from registry.studies import Facts
from survey_data.products import Product, products

ROW = pipeline(repeatability_deg=0.02, half_fov_deg=60.0, latency_us=4.0)


def place_of(*built: Product) -> Place:
    return Place(("CMOS", "Slit"), {}, built, (), ())


def product(family: str, **numbers: object) -> Product:
    return replace(products()[0], family=family, supply="", **numbers)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("task", "value"),
    [("Accuracy", 0.1), ("Precision", 0.02), ("FOV", 120.0), ("Latency", 8.0), ("Cost", None)],
)
def test_a_measured_task_goes_by_the_most_accurate_pipeline(task: str, value: float | None) -> None:
    found = task_measure(task, place_of(), ROW, 0.1, 2.0)
    assert found.value == value
    assert task_measure(task, place_of(), None, math.inf, 2.0).cost == math.inf


@pytest.mark.parametrize(("task", "column"), [("Power", "power_mw"), ("Volume", "mass_g")])
def test_a_median_is_of_three_distinct_products_at_least(task: str, column: str) -> None:
    known = [product(name, **{column: number}) for name, number in zip("abc", (9.0, 1.0, 4.0))]  # noqa: B905
    silent = product("d", **{column: None})
    few = task_measure(task, place_of(*known[:2], silent), ROW, 0.1, 1.0)
    assert (few.value, few.products) == (None, 2)
    assert "2 products" in few.words
    enough = task_measure(task, place_of(*known, silent), ROW, 0.1, 1.0)
    assert (enough.value, enough.low, enough.high, enough.products) == (4.0, 1.0, 9.0, 3)


def test_a_self_powered_product_is_named_and_is_no_zero_of_the_median() -> None:
    known = [product(name, power_mw=number) for name, number in (("a", 9.0), ("b", 5.0))]
    solar = replace(product("sun-cell"), supply="self-powered", power_mw=None)
    found = task_measure("Power", place_of(*known, solar), ROW, 0.1, 1.0)
    assert found.value is None
    assert "self-powered: sun-cell" in found.words


def test_several_tasks_go_by_the_sum_of_their_places() -> None:
    first, second = [(1.0,), (5.0,), (5.0,), (9.0,)], [(3.0,), (2.0,), (1.0,), (math.inf,)]
    assert joint_order([first, second]) == [0 + 2, 1 + 1, 1 + 0, 2 + 3]
    assert joint_order([first]) == [0, 1, 1, 2]


@pytest.mark.parametrize("task", ["Power", "Volume"])
def test_published_measures_order_the_survey_and_the_rest_goes_by_studies(
    task: str, survey: Facts
) -> None:
    column = {"Power": "power_mw", "Volume": "mass_g"}[task]
    values, counts = [], []
    for one in recommend({"task": task}, facts=survey).architectures:
        known = [n for p in one.place.products if (n := getattr(p, column)) is not None]
        (measure,) = one.measures
        assert measure.value == (median(known) if len(known) >= 3 else None)
        if measure.value is not None:
            assert not counts
            values.append(measure.value)
        else:
            counts.append(sum(task in study.of("task") for study in one.place.studies.values()))
    assert values == sorted(values)
    assert counts == sorted(counts, reverse=True)
    assert values
    assert counts


@pytest.mark.parametrize("task", ["Precision", "Latency"])
def test_the_measure_asked_for_orders_though_another_errs_less(
    task: str, facts_of: Callable[[list[dict[str, list[str]]]], Facts]
) -> None:
    facts = facts_of([{"task": [task], "detector": ["OI"], "mask": ["Slit", "Lens"]}])
    of = {"detector": "OI", "unit_own_error_deg": (0.1,)}
    rows = [
        pipeline(mask="Slit", rms_deg=0.5, repeatability_deg=0.001, latency_us=2.0, **of),
        pipeline(mask="Lens", rms_deg=0.1, repeatability_deg=0.05, latency_us=90.0, **of),
    ]
    answer = recommend({"task": task, "detector": "OI"}, rows, facts=facts)
    assert [one.place.architecture[1] for one in answer.architectures] == ["Slit", "Lens"]
