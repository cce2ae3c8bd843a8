"""What geometric experiments share: altered sensors, and parameters held at the drawing."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from algorithms.angles import sun_from_tangents
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from benchmark.claims.experiments.geometry.alterations import (
    alter,
    assemble,
    misalign,
    sensor_of,
)
from benchmark.claims.experiments.geometry.partly_fixed import PartlyFixedModel
from benchmark.datasets.standard import qpd_single_aperture

PRESET = qpd_single_aperture.PRESET
#: Tangents (alpha, beta) over a field, and spots 2.12 mm below in pixels of 0.01 mm.
TANGENTS = np.stack(np.meshgrid(np.linspace(-0.6, 0.6, 7), np.linspace(-0.6, 0.6, 7)), -1)
TANGENTS = TANGENTS.reshape(-1, 2)
SUN = sun_from_tangents(TANGENTS)
SPOTS = 212.0 * TANGENTS[:, ::-1] + (100.0, 80.0)


def _model() -> LeastSquaresGeometry:
    return LeastSquaresGeometry(focal_length_mm=2.0, unit_mm=0.01, centre=(100.0, 80.0))


def test_scaled_misalignment_is_scaled_in_every_unit_and_leaves_the_focal_length() -> None:
    twice = assemble(PRESET, partial(misalign, times=2.0))
    for unit in (0, 3):
        once = sensor_of(PRESET, unit).camera.assembly
        more = sensor_of(twice, unit).camera.assembly
        for error in ("tilt_x_deg", "tilt_y_deg", "rotation_deg", "offset_x_mm", "offset_y_mm"):
            assert getattr(more, error) == pytest.approx(2.0 * getattr(once, error), rel=1e-12)
        assert more.focal_length_error_mm == once.focal_length_error_mm != 0.0


def test_an_unchanged_sensor_sees_what_the_preset_sees() -> None:
    same = alter(PRESET, lambda sensor: sensor).for_unit(2).generate("nominal", "test", 5)
    known = PRESET.for_unit(2).generate("nominal", "test", 5)
    np.testing.assert_array_equal(same.sun, known.sun)
    np.testing.assert_array_equal(same.observations, known.observations)


def test_with_nothing_free_the_drawing_answers() -> None:
    held = PartlyFixedModel(_model(), ()).fit(SPOTS, SUN)
    # 2 mm drawn, 2.12 mm built: tangents come out 1.06 times as large
    wanted = sun_from_tangents(1.06 * TANGENTS)
    np.testing.assert_allclose(held.predict(SPOTS), wanted, atol=1e-12)


def test_the_one_free_parameter_takes_up_its_error_and_no_other_moves() -> None:
    held = PartlyFixedModel(_model(), ("focal_length_error",)).fit(SPOTS, SUN)
    (found,) = held.quality_.parameters
    assert (found.name, found.unit) == ("focal_length_error", "mm")
    assert found.value == pytest.approx(0.12, abs=1e-9)
    np.testing.assert_allclose(held.predict(SPOTS), SUN, atol=1e-9)


def test_a_free_name_that_is_no_parameter_is_refused() -> None:
    with pytest.raises(ValueError, match=r"among focal_length_error, .*got \['gap'\]"):
        PartlyFixedModel(_model(), ("gap",))
