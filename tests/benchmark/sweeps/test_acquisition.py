"""The part of a coded mask that is seen, identified in one frame of a unit nobody calibrated."""

from __future__ import annotations

import pytest

from benchmark.sweeps.acquisition import acquisition


@pytest.mark.slow
@pytest.mark.parametrize("model", ["coded-spacing", "coded-correlation"])
def test_no_direction_is_told_wrongly(model):
    """Nearly all rightly where nothing is missing; none wrongly with a fifth of the holes gone."""
    whole = acquisition("cmos-encoded", model, directions=40, unit=7)
    assert whole.wrong == 0
    assert whole.right >= 39
    broken = acquisition("cmos-encoded", model, directions=40, unit=7, missing=0.2)
    assert broken.wrong == 0
    assert broken.right + broken.ambiguous + broken.unread == 40


@pytest.mark.slow
@pytest.mark.parametrize(
    "dataset", ["cmos-encoded-sizes", "cmos-encoded-oblique", "cmos-compound-eye"]
)
def test_every_mask_tells_its_parts_apart(dataset):
    found = acquisition(dataset, directions=60, unit=3)
    assert found.wrong == 0
    assert found.right >= 54


def test_other_sensors_and_models_are_refused():
    with pytest.raises(TypeError, match="full frames"):
        acquisition("ccd-periodic", directions=1, unit=1)
