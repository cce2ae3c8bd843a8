"""Where models begin and end: ranges at their limits, designs by default, parts on their own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
)
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.panoramic import WeightedCells
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.multiplex.dial_code import DialCode
from algorithms.models.multiplex.periodic import PeriodicCode
from algorithms.models.non_physical.fourier_phase import FourierPhase
from algorithms.models.non_physical.polynomial import AxisPolynomial, SurfacePolynomial

TABLE: dict[str, Any] = {"focal_length_mm": 2.0, "unit_mm": 0.5}
DIAL: dict[str, Any] = {"bits": 5, "cell_mm": 0.3, "period_mm": 0.6, "focal_length_mm": 2.5}
PLANAR = (StandardProjection, LeastSquaresGeometry, ErrorTable, BlendedPolynomials)
FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))


# Parameters


@pytest.mark.parametrize(
    ("model", "given", "name", "inside", "outside"),
    [
        (BlendedPolynomials, TABLE, "degree", (1, 15), (0, 16)),
        (AxisPolynomial, {}, "degree", (1, 15), (0, 16)),
        (SurfacePolynomial, {}, "degree", (1, 15), (0, 16)),
        (AxisPolynomial, {}, "extrapolation", (0.0, math.inf), (-1e-9, math.nan)),
        (SurfacePolynomial, {}, "extrapolation", (0.0, math.inf), (-1e-9, math.nan)),
        (FourierPhase, DIAL, "harmonics", (1, 16), (0, 17)),
        *((model, DIAL, "bits", (1, 16), (0, 17)) for model in (PeriodicCode, FourierPhase)),
        (PeriodicCode, DIAL, "smallest_contrast", (0.0, 0.999), (-0.001, 1.0)),
        (PeriodicCode, DIAL, "cell_mm", (1e-9, 0.599), (0.0, 0.6, 0.7)),
        (WeightedCells, {"face_normals": FACES}, "largest_incidence_deg", (1e-9, 89.9), (0, 90)),
        *((model, TABLE, "interval_deg", (1e-9, 90.0), (0.0, -1.0)) for model in PLANAR[2:]),
        *((model, TABLE, "unit_mm", (1e-9, 1e9), (0.0, -1.0, math.inf)) for model in PLANAR),
    ],
)
def test_a_parameter_may_have_the_ends_of_its_range_and_nothing_beyond(
    model: Any, given: dict[str, Any], name: str, inside: Any, outside: Any
) -> None:
    for value in inside:
        assert getattr(model(**{**given, name: value}), name) == value
    for value in outside:
        with pytest.raises(ValueError, match=name):
            model(**{**given, name: value})


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
