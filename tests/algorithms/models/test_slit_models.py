"""Slit, Multi-slit, V-slit and N-slit against rays traced from slits to lines of pixels."""

from __future__ import annotations

import numpy as np
import pytest
from known_truths import rotation_about

from algorithms.angles import angles_from_sun, separation_deg, sun_from_angles
from algorithms.calibration.forward import inward, tangents_cast
from algorithms.contract import FeatureKind, SensorGeometry, UnusableDataError
from algorithms.models.geometric.multi_slit import MultiSlit
from algorithms.models.geometric.n_slit import NSlit
from algorithms.models.geometric.single_slit import DeflectedSlits
from algorithms.models.geometric.slit_pairs import DeflectedSlitPairs
from algorithms.models.geometric.v_slit import VSlit

MIDDLE = 500.0
PITCH = 0.01
PIXELS = {"pixel_pitch_mm": PITCH, "centre_px": (MIDDLE, MIDDLE)}
TWO_LINES = {**PIXELS, "line_axes": ("x", "y")}
ONE_LINE = {**PIXELS, "line_axes": ("y",)}
V = ((-3.3, 0.0, 0.1), (0.5, 45.0, 0.1))
N = ((-3.0, 45.0, 0.1), (0.0, 0.0, 0.1), (3.0, 45.0, 0.1))
ROW = ((-1.1, 0.0, 0.2), (-0.6, 0.0, 0.2), (0.0, 0.0, 0.2), (0.7, 0.0, 0.2), (1.5, 0.0, 0.2))
GLASS = ((0.5, 1.52),)

#: A model, and parameters of a built sensor far off the drawing.
BUILT = {
    "slit": (
        DeflectedSlits(focal_length_mm=3.5, slits=((0.0, 0.0, 0.1),), **TWO_LINES),
        (3.53, 0.5, 1.0, 3.48, -0.4, -0.8, 505.0, 496.0, 1.0, -0.7),
    ),
    "slit-pairs": (
        DeflectedSlitPairs(focal_length_mm=0.5, unit_mm=2.0),
        (0.51, 0.5, 1.0, 0.49, -0.4, -0.8, 0.02, -0.01, 1.0, -0.7),
    ),
    "multi-slit": (
        MultiSlit(focal_length_mm=1.2, slits=ROW, **TWO_LINES),
        (1.23, 0.05, 1.19, -0.04, 0.02, 0.5, 1.0, -0.7),
    ),
    "v-slit": (
        VSlit(focal_length_mm=1.8, slits=V, cover_glass=GLASS, **ONE_LINE),
        (1.83, 0.05, -0.04, 0.5, 0.3, 0.5, 1.0, -0.7, 0.47, 1.50),
    ),
    "n-slit": (
        NSlit(focal_length_mm=1.2, slits=N, cover_glass=GLASS, **ONE_LINE),
        (1.02, 0.05, -0.04, 45.3, 0.5, 0.3, 0.5, 1.0, -0.7),
    ),
}


def field(limit_deg, steps=11):
    axis = np.linspace(-limit_deg, limit_deg, steps)
    return sun_from_angles(np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2))


def spots_of(name, sun):
    model, truth = BUILT[name]
    truth = np.array(truth)
    return model.cast(truth, inward(sun, model.turns(truth))), truth


def met(head, slit, line, glass=()):
    """Place along a line of pixels where light of a slit meets it: one ray, three equations.

    Slit and line are a point and a way each; in the mask's frame, whose z points to the Sun, with
    the detector's axes flipped as the contract has it: light moves on by ``+tan`` as it falls.
    """
    (slit_point, slit_way), (middle, line_way) = slit, line
    found = []
    for x, y, z in head:
        ray = np.array([x / z, y / z, -1.0])
        through = np.zeros(3)
        for thickness, index in glass:
            theta = np.arcsin(np.hypot(x, y) / index)  # Snell's law
            length = np.hypot(x, y) or 1.0
            through += thickness * np.array(
                [np.tan(theta) * x / length, np.tan(theta) * y / length, -1.0]
            )
        equations = np.column_stack([slit_way, ray, -np.asarray(line_way)])
        found.append(np.linalg.solve(equations, middle - slit_point - through)[2])
    return np.array(found)


@pytest.mark.parametrize("name", BUILT)
def test_a_noiseless_sensor_is_inverted_and_its_numbers_found(name):
    sun = field(50.0)
    spots, truth = spots_of(name, sun)
    model = BUILT[name][0].fit(spots, sun)
    between = field(48.0, 8)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    assert separation_deg(model.predict(spots_of(name, between)[0]), between).max() < 1e-6
    np.testing.assert_allclose(model.vector_, truth, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("of_features", [0.0, 0.05], ids=["turntable", "pixels"])
@pytest.mark.parametrize("name", BUILT)
def test_intervals_hold_the_truth_as_often_as_they_say(name, of_features, coverage_of):
    sun = field(50.0, 7)
    spots, truth = spots_of(name, sun)
    assert 0.93 <= coverage_of(BUILT[name][0], spots, sun, truth, of_features) <= 0.97


@pytest.mark.parametrize("glass", [(), GLASS])
@pytest.mark.parametrize(("name", "slits", "height"), [("v", V, 1.83), ("n", N, 1.24)])
def test_one_line_under_slits_is_found_from_traced_rays(name, slits, height, glass):
    """The mask stands off the line, is turned against it, and all of it is turned as a head."""
    sun = field(50.0)
    head = sun @ (rotation_about(2, 0.5) @ rotation_about(1, -0.7) @ rotation_about(0, 1.0)).T
    along = np.array([0.006, 1.0, -0.004])  # the line goes along y, askew both ways
    along /= np.linalg.norm(along)
    middle = np.array([0.03, -0.05, -height])
    shifts = []
    for position, slant, _ in slits:
        rho = np.radians(slant)  # across the line runs x; a slit is y + x tan(rho) = position
        way = np.array([np.cos(rho), -np.sin(rho), 0.0])
        place = met(head, (np.array([0.0, position, 0.0]), way), (middle, along), glass)
        shifts.append(place - position)
    square = shifts[0] if name == "v" else shifts[1]
    slanted = shifts[1] if name == "v" else (shifts[0] + shifts[2]) / 2.0
    spots = MIDDLE + np.column_stack([slanted - square, square]) / PITCH  # by the drawing, 45 deg
    lines = {**ONE_LINE, "slits": slits, "cover_glass": glass}
    kind = VSlit if name == "v" else NSlit
    model = kind(focal_length_mm=height - 0.03, **lines).fit(spots, sun)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    turns = (found["rotation"], found["tilt_x"], found["tilt_y"])
    assert turns == pytest.approx((-0.5, -1.0, 0.7), abs=1e-6)
    if name == "v":
        assert found["focal_length"] == pytest.approx(height, abs=1e-6)
    else:
        assert found["K"] == pytest.approx((height - 0.03) / height, abs=1e-6)


def test_nslit_without_errors_is_the_surveys_two_equations():
    h, k, slant = 1.2, 1.08, 40.0
    slits = tuple((position, slant if position else 0.0, 0.1) for position in (-3.0, 0.0, 3.0))
    sun = field(50.0, 5)
    model = NSlit(focal_length_mm=h, slits=slits, **ONE_LINE)
    spots = model.cast(np.array([k, 0, 0, slant, 0, 0, 0, 0, 0.0]), sun[:, :2] / sun[:, 2:])
    middle, outer = model.layout()[1], model.layout()[0]
    c = (spots - MIDDLE) @ middle * PITCH
    l_and_r = 2 * (spots - MIDDLE) @ outer * PITCH
    alpha = np.arctan(c / h * k)
    delta = np.tan(np.radians(slant))
    beta = np.arctan((l_and_r / (2 * h * delta) - c / (h * delta)) * k)
    found = angles_from_sun(model.fit(spots, sun).predict(spots))
    np.testing.assert_allclose(found, np.degrees(np.column_stack([alpha, beta])), atol=1e-7)


@pytest.mark.parametrize(("theta", "delta"), [(0.7, 0.0), (0.0, 1.3), (-2.0, 0.0), (0.0, -3.0)])
def test_deflected_or_inclined_slits_are_found_from_traced_rays(theta, delta):
    """KeQiang2020: with one of the errors at a time the printed equation is exact."""
    sun = field(50.0)
    places = []
    for number in range(2):
        head = sun if number == 0 else sun[:, [1, 0, 2]]
        phi, tilt = np.radians([theta, -delta])  # as the survey counts them
        way = np.array([np.sin(phi) * np.cos(tilt), np.cos(phi) * np.cos(tilt), np.sin(tilt)])
        line = np.array([0.0, 0.0, -3.55]), np.array([1.0, 0.0, 0.0])
        places.append(met(head, (np.zeros(3), way), line))
    spots = MIDDLE + np.column_stack(places) / PITCH
    model = BUILT["slit"][0].fit(spots, sun)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    for axis in "xy":
        assert found[f"focal_length_{axis}"] == pytest.approx(3.55, abs=1e-7)
        assert found[f"deflection_{axis}"] == pytest.approx(theta, abs=1e-6)
        assert found[f"inclination_{axis}"] == pytest.approx(delta, abs=1e-6)


def across_pairs(head, theta_deg, delta_deg):
    """Balances of strips of light counted point by point over pairs of photodiodes.

    Both pairs' slits are turned or inclined about their own middles; a strip's place over a pair is
    the mean of its places along the pair's breadth.
    """
    width, gap, height = 2.8, 0.05, 0.52
    phi, tilt = np.radians([theta_deg, -delta_deg])
    way = np.array([np.sin(phi) * np.cos(tilt), np.cos(phi) * np.cos(tilt), np.sin(tilt)])
    sides = []
    for along, across in (((1.0, 1.0), (-1.0, 1.0)), ((-1.0, 1.0), (1.0, 1.0))):
        turned_head = np.column_stack(
            [head[:, :2] @ np.array(way_mm) / np.sqrt(2.0) for way_mm in (along, across)]
            + [head[:, 2]]
        )
        light = np.zeros((len(head), 2))
        for breadth in np.linspace(-1.0, 1.0, 21):
            line = np.array([0.0, breadth, -height]), np.array([1.0, 0.0, 0.0])
            middle = met(turned_head, (np.zeros(3), way), line)
            light[:, 0] += np.clip(middle + width / 2 - gap / 2, 0.0, None)
            light[:, 1] += np.clip(-gap / 2 - middle + width / 2, 0.0, None)
        sides.append(light)
    (q2, q4), (q1, q3) = (light.T for light in sides)
    total = q1 + q2 + q3 + q4
    return np.column_stack([q2 + q3 - q1 - q4, q1 + q2 - q3 - q4]) / total[:, None]


@pytest.mark.parametrize(("theta", "delta"), [(0.7, 0.0), (0.0, 1.3)])
def test_deflected_or_inclined_slits_over_pairs_are_found_from_counted_strips(theta, delta):
    """A strip's middle is what a line of pixels sees; a gap scales the balance as a height does."""
    sun = field(50.0)
    balances = across_pairs(sun, theta, delta)
    width = np.sqrt(2.0) * 2.8
    model = DeflectedSlitPairs(focal_length_mm=0.5, unit_mm=width / 2.0).fit(balances, sun)
    assert separation_deg(model.predict(balances), sun).max() < 1e-3
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    for pair in "uv":
        assert found[f"focal_length_{pair}"] == pytest.approx(0.52 * 2.8 / 2.75, rel=1e-4)
        assert found[f"deflection_{pair}"] == pytest.approx(theta, abs=1e-3)
        assert found[f"inclination_{pair}"] == pytest.approx(delta, abs=1e-3)


@pytest.mark.parametrize("share", [0.5, 0.3])
def test_rims_of_a_thick_mask_are_one_height_or_one_a_side(share):
    """eq:mslit1 and eq:mslit2 of every edge, weighed as a method may weigh left and right ones."""
    h, t = 1.2, 0.05
    sun = field(50.0)
    tangents = sun[:, :2] / sun[:, 2:]
    edges = []
    for position, _, width in ROW:
        lower, upper = h * tangents, (h + t) * tangents
        left = position - width / 2 + np.maximum(lower, upper)
        right = position + width / 2 + np.minimum(lower, upper)
        drawn = position + (share - 0.5) * width  # where the method has the slit at no tangent
        edges.append(share * right + (1 - share) * left - drawn)
    spots = MIDDLE + np.mean(edges, axis=0) / PITCH
    model = BUILT["multi-slit"][0].fit(spots, sun)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    found = {parameter.name: parameter.value for parameter in model.quality_.parameters}
    for line in "12":  # under one mask
        assert found[f"focal_length_{line}"] == pytest.approx(h + t / 2, abs=1e-7)
    assert found["sides_differ"] == pytest.approx((1 - 2 * share) * t, abs=1e-7)


@pytest.mark.parametrize("glass", [(), GLASS])
@pytest.mark.parametrize("slant", [45.0, -30.0])
def test_rows_of_two_slants_over_one_line_are_found_from_traced_rays(slant, glass):
    sun, height = field(50.0), 1.24
    head = sun @ (rotation_about(2, 0.5) @ rotation_about(1, -0.7) @ rotation_about(0, 1.0)).T
    line = np.array([0.0, 0.0, -height]), np.array([0.0, 1.0, 0.0])
    slits = ((-3.0, 0.0, 0.1), (-1.0, 0.0, 0.1), (1.0, slant, 0.1), (2.5, slant, 0.1))
    shifts = []
    for position, off, _ in slits:
        way = np.array([np.cos(np.radians(off)), -np.sin(np.radians(off)), 0.0])
        place = met(head, (np.array([0.0, position, 0.0]), way), line, glass)
        shifts.append(place - position)
    square, slanted = np.mean(shifts[:2], axis=0), np.mean(shifts[2:], axis=0)
    across = (slanted - square) / np.tan(np.radians(slant))
    spots = MIDDLE + np.column_stack([across, square]) / PITCH
    model = MultiSlit(focal_length_mm=1.2, slits=slits, cover_glass=glass, **ONE_LINE)
    model.fit(spots, sun)
    assert separation_deg(model.predict(spots), sun).max() < 1e-6
    np.testing.assert_allclose(
        model.vector_, [height, 0.0, height, 0.0, 0.0, -0.5, -1.0, 0.7], atol=1e-6
    )


@pytest.mark.parametrize("slant", [-45.0, -1.0, 1.0, 60.0])
def test_an_n_may_slant_either_way(slant):
    slits = ((-3.0, slant, 0.1), (0.0, 0.0, 0.1), (3.0, slant, 0.1))
    geometry = SensorGeometry(focal_length_mm=1.2, slits=slits, line_axes=("y",), **PIXELS)
    assert NSlit.for_sensor(geometry, FeatureKind.SPOT).slits == slits


@pytest.mark.parametrize("name", BUILT)
def test_poses_that_do_not_settle_a_sensor_are_refused(name):
    model = BUILT[name][0]
    sun = field(50.0)
    spots, _ = spots_of(name, sun)
    for rows in (np.arange(3), np.zeros(60, dtype=int)):
        with pytest.raises(UnusableDataError, match=name):
            model.fit(spots[rows], sun[rows])


@pytest.mark.parametrize(
    ("kind", "axes", "slits"),
    [
        (DeflectedSlits, ("y",), V),
        (DeflectedSlits, ("x", "x"), ((0.0, 0.0, 0.1),)),
        (DeflectedSlits, ("x", "y"), ((0.0, 5.0, 0.1),)),
        (MultiSlit, ("x", "y"), ((0.0, 0.0, 0.1),)),
        (MultiSlit, ("y",), V),
        (MultiSlit, ("x", "y"), (*V, *V)),  # four shifts are not a spot
        (VSlit, ("x", "y"), ((0.0, 0.0, 0.1),)),
        (VSlit, ("y",), N),
        (VSlit, ("y",), ((-1.0, -45.0, 0.1), (1.0, 45.0, 0.1))),
        (NSlit, ("y",), V),
        (NSlit, ("y",), ((-3.0, 45.0, 0.1), (0.0, 0.0, 0.1), (3.0, -45.0, 0.1))),
        (NSlit, ("y",), ((-3.0, 0.0, 0.1), (0.0, 0.0, 0.1), (3.0, 5e-7, 0.1))),
        (NSlit, ("y",), ()),
    ],
)
def test_other_architectures_are_refused(kind, axes, slits):
    geometry = SensorGeometry(
        focal_length_mm=1.8,
        pixel_pitch_mm=PITCH,
        centre_px=(MIDDLE, MIDDLE),
        line_axes=axes,
        slits=slits,
    )
    with pytest.raises(ValueError, match=f"{kind.about.name} needs"):
        kind.for_sensor(geometry, FeatureKind.SPOT)


@pytest.mark.parametrize("wrong", [0.0, -0.5])
def test_pairs_refuse_a_height_that_cannot_be_and_say_which(wrong):
    geometry = SensorGeometry(
        focal_length_mm=wrong,
        aperture_width_mm=4.0,
        slits=((0.0, 45.0, 2.8), (0.0, -45.0, 2.8)),
    )
    with pytest.raises(ValueError, match=f"focal_length_mm .* {wrong}$"):
        DeflectedSlitPairs.for_sensor(geometry, FeatureKind.BALANCE)


def test_a_fold_has_no_direction():
    """Where the features run back, two directions cast the same ones; the far one is not found."""

    def bent(t):
        return t - t**3 / 3.0  # turns at 1

    wanted = bent(np.array([[0.5, 0.0], [0.9, 0.2]]))
    found = tangents_cast(bent, wanted, wanted)
    np.testing.assert_allclose(found, [[0.5, 0.0], [0.9, 0.2]], atol=1e-9)
    beyond = tangents_cast(bent, wanted, np.array([[1.6, 0.0], [1.2, 0.2]]))
    assert np.isnan(beyond[0]).all()
    assert np.isnan(tangents_cast(bent, np.array([[0.7, 0.0]]), np.zeros((1, 2)))).all()
