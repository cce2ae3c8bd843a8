"""Where models begin and end: ranges at their limits, designs by default, parts on their own."""

from __future__ import annotations

import math

import numpy as np
import pytest

from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.models.geometric.panoramic import WeightedCells
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.multiplex.dial_code import DialCode


def pyramid(tilt_deg: float, count: int = 4) -> tuple[tuple[float, float, float], ...]:
    off, turns = math.radians(tilt_deg), 2 * math.pi * np.arange(count) / count
    return tuple(
        (math.sin(off) * math.cos(t), math.sin(off) * math.sin(t), math.cos(off)) for t in turns
    )


@pytest.mark.parametrize(("share", "dark"), [(0.0, [False, True]), (0.5, [False, True])])
def test_a_face_is_dark_up_to_its_share_of_the_largest(share: float, dark: list[bool]) -> None:
    model = RegularPyramid(pyramid(30.0), dark_fraction=share, extrapolation=math.inf)
    model.fit([[1.0, 1.0, 1.0, 1.0]], [[0.0, 0.0, 1.0]])
    rows = [[0.8, 0.7, 0.6, share * 0.8 + 1e-9], [0.8, 0.7, 0.6, share * 0.8]]
    assert np.isnan(model.predict(rows)).all(axis=1).tolist() == dark


# Designs


@pytest.mark.parametrize(("half_deg", "fits"), [(34.9, True), (35.1, False)])
def test_cells_serve_a_field_in_whose_every_direction_three_are_lit(
    half_deg: float, fits: bool
) -> None:
    """Three tilted cells: in the plane of one, opposite to it, it is off by tilt and half field."""
    sensor = SensorGeometry(face_normals=pyramid(40.0, 3), half_fov_deg=half_deg)
    if fits:
        assert WeightedCells.for_sensor(sensor, FeatureKind.SIGNALS)
    else:
        with pytest.raises(UnsuitableDesignError, match="3 faces leave 2"):
            WeightedCells.for_sensor(sensor, FeatureKind.SIGNALS)


# Dials


def test_a_track_is_open_above_the_mean_of_all_four_fine_rows() -> None:
    """Offsets common to a pair move the mean and no phase."""
    code = DialCode(3, 0.3, 0.6, 2.0, ("x", "y"), 0.1)
    # F1..F4 of phase 0.3 turns about 0.5, the first pair lifted by 0.2
    phase = 0.3 * 2 * np.pi
    wave = 0.3 * np.array([-np.cos(phase), -np.sin(phase), np.cos(phase), np.sin(phase)])
    fine = 0.5 + wave + [0.2, 0.0, 0.2, 0.0]
    half = 0.6
    for coarse, cell in (([1, 1, 0], 4), ([0, 1, 1], 2)):
        tracks = np.where(coarse, half + 1e-9, half - 1e-9)
        places, phases = code.read(np.tile([*tracks, *fine], 2)[None])
        rough = (cell + 0.5 - 4) * 0.3
        exact = 0.3 * 0.6 + 0.6 * round((rough - 0.3 * 0.6) / 0.6)
        assert phases == pytest.approx(np.full((1, 2), phase))
        assert places == pytest.approx(np.full((1, 2), exact / 2.0))


@pytest.mark.parametrize(("contrast", "context"), [(0.2001, True), (0.1999, False)])
def test_a_dial_is_read_down_to_its_smallest_contrast(contrast: float, context: bool) -> None:
    code = DialCode(3, 0.3, 0.6, 2.0, ("x", "y"), 0.2)
    phase = 0.15 / 0.6 * 2 * np.pi
    wave = contrast * np.array([-np.cos(phase), -np.sin(phase), np.cos(phase), np.sin(phase)])
    one = [1.0, 1.0, 0.0, *(0.5 * (1 + wave))]  # cell 4, middle of it
    places, _ = code.read(np.tile(one, 2)[None])
    assert np.isfinite(places).all() == context
