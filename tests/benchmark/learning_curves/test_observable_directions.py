"""Learning curves are scored over the test samples whose direction can be observed (pins)."""

import pytest
from fake_poses import Lines, Plane, Readings
from fake_results import numbers

from benchmark.contract import Cell
from benchmark.datasets.pins import Pin
from benchmark.experiments.learning_curves import LearningCurves
from benchmark.plan.parts import Parts
from benchmark.results.components import current
from benchmark.results.store import Store


@pytest.mark.parametrize(("observable", "every"), [(2000, True), (1999, False), (1, False)])
def test_all_samples_count_only_where_all_are_pinned_as_observable(tmp_path, observable, every):
    """Else an eclipse, or a Sun behind the sensor, would count as an error of the pipeline."""
    parts = Parts({"fake-plane": Plane()}, {"fake-readings": Readings}, {"fake-lines": Lines})
    cell = Cell("fake-plane", "nominal", "fake-readings", "fake-lines")
    pin = Pin("fake-plane", "nominal", "test", 1, 2000, "h", "hh", observable, 0.1, 0.1)
    scores = {cell: numbers(0.1, rms_all_answers_deg=0.1, bound_deg=0.1)}
    Store(tmp_path).write(scores, [pin], current(parts))
    curves = LearningCurves(tmp_path, parts)
    (task,) = curves.tasks(curves.cells())
    assert task.all_observable is every
