"""Where models begin and end: ranges at their limits, designs by default, parts on their own."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from algorithms.angles import sun_from_angles
from algorithms.contract import (
    FeatureKind,
    SensorGeometry,
    UnsuitableDesignError,
    UnusableDataError,
)
from algorithms.models.geometric.detector_faces import (
    UNIT_TOLERANCE,
    directions,
    require_normals,
)
from algorithms.models.geometric.least_squares import LeastSquaresGeometry
from algorithms.models.geometric.panoramic import WeightedCells
from algorithms.models.geometric.pyramidal import RegularPyramid
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.error_tables import (
    MAX_NODES,
    GridAxis,
    interpolation_matrix,
    require_size,
    row_roughness,
    surface_roughness,
)
from algorithms.models.lut.lookup_table import ErrorTable
from algorithms.models.multiplex.dial_code import DialCode, sun_from_fractions
from algorithms.models.multiplex.periodic import PeriodicCode
from algorithms.models.nominal_projection import nominal_projection, nominal_tangents
from algorithms.models.non_physical.fourier_phase import FourierPhase
from algorithms.models.non_physical.polynomial import AxisPolynomial, SurfacePolynomial
from algorithms.models.non_physical.regression_axes import feature_scaling, solve_regression

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


def test_a_nominal_projection_is_read_off_the_drawing() -> None:
    sensor = SensorGeometry(
        focal_length_mm=2.0, pixel_pitch_mm=0.01, centre_px=(30.0, 20.0), aperture_width_mm=0.8
    )
    spot = nominal_projection(sensor, FeatureKind.SPOT, StandardProjection.about)
    assert spot == {"focal_length_mm": 2.0, "unit_mm": 0.01, "centre": (30.0, 20.0)}
    balance = nominal_projection(sensor, FeatureKind.BALANCE, StandardProjection.about)
    assert balance == {"focal_length_mm": 2.0, "unit_mm": 0.4, "centre": (0.0, 0.0)}
    found = nominal_tangents(np.array([[130.0, 70.0]]), **spot)
    np.testing.assert_allclose(found, [[50 * 0.01 / 2, 100 * 0.01 / 2]])  # alpha goes with y


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


# Faces


@pytest.mark.parametrize(
    ("length", "unit"), [(0.9, True), (-0.9, True), (1.1, False), (-1.1, False)]
)
def test_normals_are_units_within_the_tolerance(length: float, unit: bool) -> None:
    faces = np.array(FACES[::2], dtype=float)
    faces[1] *= 1 + length * UNIT_TOLERANCE
    assert pytest.approx(1e-6) == UNIT_TOLERANCE
    if unit:
        np.testing.assert_array_equal(require_normals(faces, "test"), faces)
    else:
        with pytest.raises(UnsuitableDesignError):
            require_normals(faces, "test")


@pytest.mark.parametrize(
    "faces",
    [
        FACES[:4],  # in one plane
        FACES[::2][:2],
        ((1, 0), (0, 1), (1, 0)),
        ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0)),
        (1, 0, 0),
    ],
)
def test_normals_that_do_not_span_space_are_refused(faces: Any) -> None:
    with pytest.raises(UnsuitableDesignError, match="test needs at least three unit"):
        require_normals(faces, "test")


@pytest.mark.parametrize(
    ("half_deg", "lowest"), [(25.0, math.cos(math.radians(25.0))), (None, -1.0)]
)
def test_directions_fill_the_field_evenly_and_follow_its_rim(
    half_deg: float | None, lowest: float
) -> None:
    found = directions(half_deg, 2000)
    assert found.shape == (2200, 3)
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), 1.0, rtol=1e-12)
    inside, rim = found[:2000], found[2000:]
    np.testing.assert_allclose(rim[:, 2], lowest, atol=1e-12)
    # even in solid angle: z is uniform, and no side has more than the other
    heights = np.sort(inside[:, 2])
    np.testing.assert_allclose(heights, np.linspace(lowest, 1, 2001)[:-1] + (1 - lowest) / 4000)
    np.testing.assert_allclose(inside[:, :2].mean(axis=0), 0.0, atol=1e-3)
    # nowhere a hole: twice the distance of neighbours on a square grid
    rng = np.random.default_rng(1)
    z, turn = rng.uniform(lowest, 1, 300), rng.uniform(0, 2 * np.pi, 300)
    wide = np.sqrt(1 - z**2)
    asked = np.column_stack([wide * np.cos(turn), wide * np.sin(turn), z])
    nearest = np.arccos(np.clip(asked @ found.T, -1, 1).max(axis=1))
    assert nearest.max() < 2 * math.sqrt(2 * math.pi * (1 - lowest) / 2000)
    if half_deg is not None:
        turns = np.sort(np.arctan2(rim[:, 1], rim[:, 0]))
        assert np.diff(turns).max() < 1.01 * 2 * np.pi / 199


# Tables


def test_an_axis_has_nodes_at_multiples_that_enclose_all() -> None:
    assert GridAxis.over(np.array([-3.1, 4.9]), 2.0) == GridAxis(-4.0, 2.0, 6)
    assert GridAxis.over(np.array([-4.0, 6.0]), 2.0) == GridAxis(-4.0, 2.0, 6)
    assert GridAxis.over(np.array([2.0, 2.0]), 2.0) == GridAxis(2.0, 2.0, 2)


def test_a_cell_is_that_between_two_nodes_and_end_cells_go_on() -> None:
    axis = GridAxis(-4.0, 2.0, 4)  # nodes at -4, -2, 0, 2
    lower, past = axis.cells(np.array([-5.0, -4.0, -2.5, -2.0, 1.9, 2.0, 3.0, np.nan]))
    assert lower[:-1].tolist() == [0, 0, 0, 1, 2, 2, 2]
    np.testing.assert_allclose(past[:-1], [-0.5, 0.0, 0.75, 0.0, 0.95, 1.0, 1.5])
    assert np.isnan(past[-1])
    weights = interpolation_matrix(axis, np.array([-2.5, 2.0])).toarray()
    np.testing.assert_allclose(weights, [[0.25, 0.75, 0, 0], [0, 0, 0, 1]])


def test_roughness_is_of_what_bends() -> None:
    """Planes have none; of a parabola along one axis each second difference is 2."""
    rows, columns = 5, 4
    i, j = (axis.ravel() for axis in np.mgrid[:rows, :columns].astype(float))
    rough = surface_roughness(rows, columns)

    def of(matrix: Any, values: Any) -> float:
        return float(values @ (matrix @ values))

    assert of(rough, 3.0 + 2.0 * i - 5.0 * j) == pytest.approx(0.0, abs=1e-9)
    assert of(rough, i**2) == pytest.approx(4.0 * (rows - 2) * columns)
    assert of(rough, j**2) == pytest.approx(4.0 * rows * (columns - 2))
    assert of(rough, i * j) == pytest.approx((rows - 1) * (columns - 1))
    terms = row_roughness(rows, columns)
    assert of(terms, 3.0 + 2.0 * i - 5.0 * j**3) == pytest.approx(0.0, abs=1e-9)
    assert of(terms, i * j) == pytest.approx(0.0, abs=1e-9)
    assert of(terms, i**2) == pytest.approx(4.0 * (rows - 2) * columns)


def test_a_table_may_be_as_large_as_can_be_solved() -> None:
    require_size(MAX_NODES, "test", 1.0)
    with pytest.raises(UnusableDataError, match=f"{MAX_NODES + 1} unknowns"):
        require_size(MAX_NODES + 1, "test", 1.0)


def test_rows_of_polynomials_say_how_many_terms_are_settled() -> None:
    axis = np.linspace(-20.0, 20.0, 9)
    angles = np.stack(np.meshgrid(axis, axis[::2]), axis=-1).reshape(-1, 2)  # 5 different beta
    rows = BlendedPolynomials(focal_length_mm=1.0, unit_mm=1.0, degree=8, smoothing=1e-3)
    with pytest.raises(UnusableDataError, match=r"settle 18.*10"):
        rows.fit(np.tan(np.radians(angles[:, ::-1])), sun_from_angles(angles))


# Regressions


def test_features_are_scaled_onto_minus_one_to_one_each_by_itself() -> None:
    features = np.array([[10.0, -3.0], [30.0, -1.0], [14.0, 5.0]])
    middle, half = feature_scaling(features, "test")
    np.testing.assert_array_equal(middle, [20.0, 1.0])
    np.testing.assert_array_equal(half, [10.0, 4.0])
    with pytest.raises(UnusableDataError, match="all have 4 in column 1"):
        feature_scaling(np.array([[1.0, 4.0], [2.0, 4.0]]), "test")


def test_a_regression_is_settled_by_as_many_samples_as_terms() -> None:
    design = np.vander(np.array([-1.0, 0.0, 1.0]), 3)
    wanted = design @ np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]])
    np.testing.assert_allclose(
        solve_regression(design, wanted, "test"), [[1, 2], [3, 4], [5, 6]], atol=1e-12
    )
    with pytest.raises(UnusableDataError, match="3 given settle only 2"):
        solve_regression(design[[0, 1, 1]], wanted, "test")


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


def test_a_direction_behind_the_detector_is_none() -> None:
    found = sun_from_fractions(
        np.array([[0.3, 0.4], [0.3, 0.4], [0.3, 0.4]]), np.array([[2.0], [0.0], [-1.0]])
    )
    np.testing.assert_allclose(found[0, :2] / found[0, 2], [0.15, 0.2])
    assert np.isnan(found[1:]).all()
