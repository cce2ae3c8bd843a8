"""Quadrants, faces and sensors of one axis under the names that readers give them."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import table

from calibrate.forms.attitudes import sun_by_date
from calibrate.readings import quadrant_balances, readings_of
from calibrate.roles import guess, understood

ANGLES = bench.grid(9, 25.0)
SUN = bench.sun_of(ANGLES)
QUADRANTS = bench.quadrants(SUN, 3)
AROUND = bench.sphere(400, 5)
FACES = bench.faces(AROUND, 6)
VECTOR = ("sun_x", "sun_y", "sun_z")
TURNED = ("theta_x_deg", "theta_y_deg")
NORMALS = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]]


@pytest.mark.parametrize(
    "names",
    [
        ("UL", "UR", "LR", "LL"),
        ("q_ul", "q_ur", "q_lr", "q_ll"),
        ("TL [mV]", "TR [mV]", "BR [mV]", "BL [mV]"),
        ("upper left", "upper right", "lower right", "lower left"),
        ("NW", "NE", "SE", "SW"),
        ("Q_II", "Q_I", "Q_IV", "Q_III"),
        ("q1", "q2", "q3", "q4"),
        ("A", "B", "C", "D"),
    ],
)
@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 0, 2)])
def test_quadrants_are_ordered_by_their_names(
    names: tuple[str, ...], order: tuple[int, ...]
) -> None:
    made = table((*(names[at] for at in order), *TURNED), QUADRANTS[:, list(order)], ANGLES)
    settings = guess(made)
    assert settings.readings.kind == "quadrants"
    assert settings.readings.columns == names
    found = readings_of(made, settings)
    assert found.features == pytest.approx(quadrant_balances(QUADRANTS), abs=1e-12)


@pytest.mark.parametrize(
    "names",
    [
        ("xp", "xm", "yp", "ym", "zp", "zm"),
        ("css_x_plus", "css_x_minus", "css_y_plus", "css_y_minus", "css_z_plus", "css_z_minus"),
        ("+X [mA]", "-X [mA]", "+Y [mA]", "-Y [mA]", "+Z [mA]", "-Z [mA]"),
        ("plus_x", "minus_x", "plus_y", "minus_y", "plus_z", "minus_z"),
    ],
)
def test_names_of_faces_say_their_normals(names: tuple[str, ...]) -> None:
    settings = guess(table((*names, *VECTOR), FACES, AROUND))
    assert settings.readings.columns == names
    assert np.array_equal(np.asarray(settings.sensor.face_normals), NORMALS)


def test_faces_with_normals_tell_vectors_from_the_sun() -> None:
    names = ("xp", "xm", "yp", "ym", "zp", "zm", *VECTOR)
    towards, away = (understood(table(names, FACES, sun)) for sun in (AROUND, -AROUND))
    assert not towards.settings.direction.from_light
    assert away.settings.direction.from_light
    assert readings_of(table(names, FACES, -AROUND), away.settings).sun == pytest.approx(AROUND)
    assert any("from the light" in note for note in away.notes)
    # readings that fall when light rises are another thing
    falling = guess(table(names, 1.2 - FACES, AROUND))
    assert not falling.direction.from_light


def test_faces_of_any_names_are_channels() -> None:
    names = ("front", "back", "port", "starboard", "top", "bottom")
    found = understood(table((*names, *VECTOR), FACES, AROUND))
    assert found.settings.readings.kind == "channels"
    assert found.settings.readings.columns == names
    assert any("front, back" in note for note in found.notes)


@pytest.mark.parametrize("date", ["date", "time"])
def test_attitude_and_date_give_the_suns_direction(date: str) -> None:
    from scipy.spatial.transform import Rotation

    seconds = 1_772_445_600.0 + 60.0 * np.arange(len(AROUND))
    sun = sun_by_date(seconds)
    turns = Rotation.random(len(AROUND), rng=np.random.default_rng(7))
    seen = turns.apply(sun)
    made = table(
        (date, "q1", "q2", "q3", "q4", *(f"pd{n}" for n in range(1, 7))),
        seconds, turns.as_quat(), bench.faces(seen, 8),
    )  # fmt: skip
    found = understood(made)
    assert found.settings.direction.light_by_date == date
    assert readings_of(made, found.settings).sun == pytest.approx(seen, abs=1e-9)


@pytest.mark.slow
def test_the_almanac_is_that_of_astropy_to_some_thousandths_of_a_degree() -> None:
    time = pytest.importorskip("astropy.time")
    coordinates = pytest.importorskip("astropy.coordinates")
    iers = pytest.importorskip("astropy.utils.iers")
    seconds = np.random.default_rng(3).uniform(1.45e9, 1.85e9, 200)  # 2015 to 2028
    with iers.conf.set_temp("auto_download", False):
        moments = time.Time(seconds, format="unix", scale="utc")
        apparent = coordinates.get_body("sun", moments, ephemeris="builtin")
        frame = apparent.transform_to(coordinates.GCRS(obstime=moments))
        vectors = frame.cartesian.xyz.value.T
    vectors = vectors / np.linalg.norm(vectors, axis=1)[:, None]
    off = np.degrees(np.linalg.norm(vectors - sun_by_date(seconds), axis=1))
    assert off.max() < 0.006


LINE = np.linspace(-40.0, 40.0, 41)
ONE = np.column_stack([np.sin(np.radians(LINE)), 0.0 * LINE, np.cos(np.radians(LINE))])
QUARTERS = np.column_stack([1 - ONE[:, 0], 1 + ONE[:, 0], 1 + ONE[:, 0], 1 - ONE[:, 0]])


@pytest.mark.parametrize(
    ("names", "columns", "kind"),
    [
        (("x_px", "theta_deg"), (300.0 * np.tan(np.radians(LINE)), LINE), "spot"),
        (("balance", "angle"), (np.sin(np.radians(LINE)), LINE), "balance"),
        (("pd_a", "pd_b", "sun_angle [mrad]"), (1 + ONE[:, 0], 1 - ONE[:, 0], None), "pair"),
        (("UL", "UR", "LR", "LL", "theta [deg]"), (*QUARTERS.T, LINE), "quadrants"),
        (("right", "left", "table [deg]"), (1 + ONE[:, 0], 1 - ONE[:, 0], LINE), "pair"),
    ],
)
def test_one_reading_or_two_photodiodes_of_one_angle(
    names: tuple[str, ...], columns: tuple[np.ndarray | None, ...], kind: str
) -> None:
    radians = np.radians(LINE) * 1e3
    made = table(names, *(radians if column is None else column for column in columns))
    settings = guess(made)
    assert settings.direction.form == "one-angle"
    assert settings.readings.kind == kind
    found = readings_of(made, settings)
    assert found.sun == pytest.approx(ONE, abs=1e-12)
    if kind in ("pair", "quadrants"):
        assert found.features[:, 0] == pytest.approx(ONE[:, 0], abs=1e-12)
