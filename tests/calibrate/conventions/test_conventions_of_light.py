"""Light that readings fall with, and faces that look elsewhere than stated."""

from __future__ import annotations

import bench
import numpy as np
import pytest
from samples import found_in, samples, table

from algorithms.contract import FeatureKind
from calibrate.conventions.channels import face_normals
from calibrate.table import TableError

ANGLES = bench.grid(15, 40.0)
FACES = ("xp", "xm", "yp", "ym", "zp", "zm")
VECTOR = ("sun_x", "sun_y", "sun_z")
SPHERE = bench.sphere(300, 1)
SIGNALS = bench.faces(SPHERE, 2)
DARK = 3.0


def test_quadrants_that_fall_when_light_rises_are_found_with_their_level() -> None:
    light = bench.quadrants(bench.sun_of(ANGLES / 2.0), 2)
    names = ("q1", "q2", "q3", "q4", "theta_x_deg", "theta_y_deg")
    found = found_in(table(names, DARK - light, ANGLES / 2.0))
    (one,) = (one for one in found if one.about == "light")
    assert one.certain
    change = one.change["readings"]
    assert isinstance(change, dict)
    assert change["inverted"] is True
    # the bench's quadrants all see 0.02 beside
    assert change["dark"] == pytest.approx([DARK - 0.02] * 4, abs=0.002)


def test_faces_that_fall_are_found_with_their_level_without_light() -> None:
    (found,) = found_in(table((*FACES, *VECTOR), DARK - SIGNALS, SPHERE))
    assert (found.about, found.certain) == ("light", True)
    change = found.change["readings"]
    assert isinstance(change, dict)
    assert change["inverted"] is True
    assert change["dark"] == pytest.approx([DARK] * 6, abs=0.01)


def test_exchanged_channels_look_where_the_other_is_stated_to() -> None:
    exchanged = SIGNALS[:, [1, 0, 2, 3, 4, 5]]
    found = found_in(table((*FACES, *VECTOR), exchanged, SPHERE))
    assert [one.found for one in found] == [
        "channel xp looks where xm is stated to",
        "channel xm looks where xp is stated to",
    ]
    assert all(one.certain and one.before_deg > 170.0 and one.after_deg < 5.0 for one in found)


def test_a_channel_that_sees_no_light_looks_nowhere() -> None:
    signals = SIGNALS.copy()
    signals[:, 2] = 0.0
    signals[:, 3] = -np.maximum(SPHERE @ [0.0, -1.0, 0.0], 0.0)
    normals, explained = face_normals(samples(signals, SPHERE, FeatureKind.SIGNALS))
    assert normals[2].tolist() == [0.0, 0.0, 0.0]
    assert explained[2] == 0.0
    assert normals[3] @ [0.0, -1.0, 0.0] < -0.95  # away from light that it falls with
    assert explained[[0, 1, 4, 5]] == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("dark", [0.0, -0.3], ids=["no level", "a level"])
def test_quadrants_of_which_no_row_has_a_positive_sum_are_said_to_fall(dark: float) -> None:
    light = bench.quadrants(bench.sun_of(ANGLES / 2.0), 2)
    names = ("q1", "q2", "q3", "q4", "theta_x_deg", "theta_y_deg")
    with pytest.raises(TableError, match="fall when light rises: say inverted = true"):
        found_in(table(names, dark - light, ANGLES / 2.0))
