"""Each task is ranked by its own measure, in an order that a person can check with a pencil."""

import math
from statistics import median

import pytest

from registry import ranking
from registry.ranking import TaskMeasure, joint_cost, key_of, task_measures
from registry.recommendation import recommend
from registry.studies import facts
from survey_data.hardware import Hardware, hardware
from tests.registry.brute_force import measured_pipeline


def ranked(task: str, rows: list[object]) -> list[tuple[str, str]]:
    answer = recommend({"task": task}, rows, facts=facts())  # type: ignore[arg-type]
    return [(a.detector, a.mask) for a in answer.architectures]


def test_power_and_volume_go_by_what_makers_publish_whatever_errs_least() -> None:
    for task, of in (("Power", "power_mw"), ("Volume", "mass_g")):
        answer = recommend({"task": task}, facts=facts())
        for a in answer.architectures:
            numbers = [
                getattr(one, of)
                for one in hardware().values()
                if (one.detector, one.mask) == (a.detector, a.mask) and getattr(one, of) is not None
            ]
            (measure,) = a.measures
            assert measure["basis"] == "published"
            assert measure["built"] == len(numbers)
            assert measure["value"] == (median(numbers) if numbers else None)
        known = [a.measures[0]["value"] is not None for a in answer.architectures if a.studies]
        assert known == sorted(known, reverse=True)  # who publishes nothing comes after
        silent = [
            (a.detector, a.mask) for a in answer.architectures if a.measures[0]["value"] is None
        ]
        fine = measured_pipeline(*silent[-1], 1e-4)  # no error stands in for what is not published
        assert ranked(task, [fine])[0] not in silent


@pytest.mark.parametrize("task", ["Precision", "Latency"])
def test_precision_goes_by_repeatability_and_latency_by_the_time(task: str) -> None:
    one, other, *_ = ranked(task, [])
    coarse = measured_pipeline(*one, 0.5, repeatability_deg=0.001, latency_us=2.0)
    fine = measured_pipeline(*other, 0.1, repeatability_deg=0.05, latency_us=90.0)
    assert ranked(task, [coarse, fine])[0] == one
    swapped = measured_pipeline(*other, 0.5, repeatability_deg=0.001, latency_us=2.0)
    assert ranked(task, [swapped, measured_pipeline(*one, 0.1, repeatability_deg=0.05)])[0] == other


def test_several_tasks_go_by_the_geometric_mean_and_unknown_is_last() -> None:
    one = TaskMeasure("Accuracy", "deg", 0.01)
    wide, narrow = TaskMeasure("FOV", "deg", 120.0), TaskMeasure("FOV", "deg", 60.0)
    assert joint_cost([one, wide]) == pytest.approx(math.sqrt(0.01 * 3.0))
    assert joint_cost([one, narrow]) == pytest.approx(math.sqrt(2.0) * joint_cost([one, wide]))
    assert joint_cost([one, TaskMeasure("Power", "mW", None)]) == math.inf
    assert TaskMeasure("Power", "mW", 0.0, 5).cost == 1.0
    assert "nothing published of built sensors" in TaskMeasure("Power", "mW", None).words
    assert TaskMeasure("Volume", "g", 30.0, 2).words.endswith("of 2 built sensors")


def test_what_is_backed_and_measured_comes_first_then_what_is_backed_alone() -> None:
    both = key_of("advice", True, 0.0, 0.5)
    studied = key_of("advice", False, 3.0, 0.6)
    alone = key_of("advice", True, 0.0, math.inf)
    rest = [key_of("advice", False, 0.0, error) for error in (0.01, math.inf)]
    assert sorted([*rest, alone, studied, both]) == [both, studied, alone, *rest]
    assert key_of("advice", False, 1.0, 0.3, of_errors=True) > key_of(
        "advice", True, 0.0, math.inf, of_errors=True
    )


def test_the_field_of_view_is_measured_as_a_full_angle() -> None:
    advised = recommend({"task": "FOV"}, facts=facts()).architectures[0]
    row = measured_pipeline(advised.detector, advised.mask, 0.1)
    answer = recommend({"task": "FOV"}, [row], facts=facts())
    found = [one["value"] for a in answer.architectures for one in a.measures]
    assert [value for value in found if value is not None] == [120.0]
    assert {one["built"] for a in answer.architectures for one in a.measures} == {0}


def test_power_and_volume_are_known_each_by_itself_and_cost_where_both_are(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def built(key: str, mask: str, power_mw: float | None, mass_g: float | None) -> Hardware:
        seen = {"fov_full_deg": None, "accuracy_deg": None, "precision_deg": None}
        return Hardware(
            key, key, "CMOS", mask, accuracy_kind="", basis="title", source="",
            power_mw=power_mw, mass_g=mass_g, **seen,
        )  # fmt: skip

    sensors = [
        *(built("a", "Slit", None, 30.0), built("b", "Slit", None, 50.0)),
        *(built("c", "Lens", 80.0, None), built("d", "Encoded", 9.0, 4.0)),
        *(built("e", "", 1.0, 1.0), built("f", "Encoded", 9.0, None)),
    ]
    monkeypatch.setattr(ranking, "hardware", lambda: {one.id: one for one in sensors})
    medians = ranking._published_medians.__wrapped__  # what is cached stays
    monkeypatch.setattr(ranking, "_published_medians", medians)
    tasks = ("Power", "Volume", "Cost")
    found = {
        mask: [
            (m.value, m.sensor_count) for m in task_measures(tasks, ("CMOS", mask), None, math.inf)
        ]
        for mask in ("Slit", "Lens", "Encoded", "Maskless")
    }
    assert found == {
        "Slit": [(None, 0), (40.0, 2), (None, 0)],
        "Lens": [(80.0, 1), (None, 0), (None, 0)],
        "Encoded": [(9.0, 2), (4.0, 1), (6.0, 1)],
        "Maskless": [(None, 0)] * 3,
    }
