"""What drawn benches add to an error, beside own errors of the same readings."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from benchmark import datasets
from benchmark.contract import ON_BENCH
from benchmark.plan.parts import installed_parts
from benchmark.running.fitting import BENCHES
from benchmark.running.judging import _pooled
from benchmark.running.stages import Task
from benchmark.running.task import measure

MODELS = ("lut-polynomial", "slit")


@pytest.fixture(scope="module")
def measured():
    parts = installed_parts()
    preset = datasets.get("pda-slit")
    task = Task(
        preset,
        "nominal",
        parts.extractor("linear-phase"),
        tuple(parts.model(name) for name in MODELS),
        unit=2,
        all_observable=True,
    )
    own, bench = (measure(replace(task, condition=name)) for name in ("nominal", ON_BENCH))
    return preset, own.outcomes, bench.outcomes


def test_own_error_and_bench_add_in_squares(measured):
    """Over the benches drawn here; a rotation that alignment takes away is most of a bench."""
    preset, own, bench = measured
    for one, other in zip(own, bench, strict=True):
        added = np.sqrt(other.score.rms_deg**2 - one.score.rms_deg**2)
        assert 0.2 < added / preset.reference_error_deg("nominal") < 2.5
        assert one.score.rms_deg < 1.02 * other.score.aligned_deg < other.score.rms_deg


def test_errors_of_samples_are_those_the_score_is_made_of(measured):
    _, own, bench = measured
    for one, other in zip(own, bench, strict=True):
        given = one.sample_errors_deg
        assert one.score.rms_deg == pytest.approx(np.sqrt(np.nanmean(given**2)))
        assert one.found.shape == given.shape
        assert other.sample_errors_deg is None
    assert BENCHES == 2


def test_each_bench_is_aligned_by_itself():
    """Two benches off by a turn to either side: nothing is left of each, of both together all."""
    x, y = np.meshgrid(np.linspace(-0.3, 0.3, 7), np.linspace(-0.3, 0.3, 7))
    sun = np.column_stack([x.ravel(), y.ravel(), np.sqrt(1 - x.ravel() ** 2 - y.ravel() ** 2)])
    turn = math.radians(0.5)
    turned = []
    for angle in (turn, -turn):
        cosine, sine = math.cos(angle), math.sin(angle)
        turned.append(sun @ np.array([[1, 0, 0], [0, cosine, sine], [0, -sine, cosine]]))
    data = SimpleNamespace(
        splits={"test": SimpleNamespace(sun=sun)}, observable=np.ones(len(sun), dtype=np.bool_)
    )
    found = _pooled(SimpleNamespace(test=turned), data)
    assert 0.45 < found.rms_deg <= 0.5
    assert found.aligned_deg < 1e-6
