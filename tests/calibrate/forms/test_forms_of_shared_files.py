"""Files of one good sensor in many forms: the samples are those of the plain one."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from bench import sun_of
from scipy.spatial.transform import Rotation

from calibrate.conventions.findings import findings
from calibrate.readings import Readings, readings_of
from calibrate.roles import guess
from calibrate.table import read_table
from calibrate.template import preview

CASES = Path(os.environ.get("SUNATLAS_CASES", Path(__file__).parents[4] / "shared" / "cases"))
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason="no ../shared beside this checkout")
SPOTS = [
    *("form-02_np_savetxt.txt", "form-04_comment_lines.csv", "form-05_units_row.csv"),
    *("form-06_units_brackets.csv", "form-08_degree_sign_latin1.csv", "form-10_dms.csv"),
    *("form-11_trailing_comma.csv", "form-14b_empty_index_name.csv", "form-21_title_rows.xlsx"),
    "form-33_quaternion.csv",
]


def samples_of(name: str) -> Readings:
    table = read_table(CASES / name)
    return readings_of(table, guess(table))


def columns_of(name: str, **said: object) -> np.ndarray:
    return np.loadtxt(CASES / name, delimiter=",", skiprows=1, **said)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", SPOTS)
def test_spots_and_directions_are_those_of_the_plain_table(name: str) -> None:
    plain = np.loadtxt(CASES / "form-02_np_savetxt.txt")
    found = samples_of(name)
    assert found.features == pytest.approx(plain[:, :2], abs=6e-5)  # four decimals of a pixel
    assert found.sun == pytest.approx(sun_of(plain[:, 2:]), abs=2e-6)  # six of a quaternion


def test_an_attitude_turns_the_suns_direction_into_the_sensors_frame() -> None:
    name = "form-80_attitude_ephemeris.csv"
    columns = columns_of(name)
    attitude = Rotation.from_quat(np.roll(columns[:, 6:10], -1, axis=1))
    sun = attitude.apply(columns[:, 10:])
    found = samples_of(name)
    assert found.sun == pytest.approx(sun[found.rows - 2], abs=1e-6)
    # of a box with cells on all sides, those lit follow the cosine of their own normal
    cosine = np.corrcoef(found.features.T, found.sun.T)[:6, 6:]
    assert np.abs(cosine).max(axis=1).min() > 0.8


@pytest.mark.parametrize("name", [path.name for path in sorted(CASES.glob("form-*"))])
def test_every_form_is_shown_with_the_role_of_its_columns(name: str) -> None:
    shown = preview(CASES / name)
    assert shown["refused"] == ""
    assert all(len(one["first"]) == 5 for one in shown["columns"])
    roles = {one["name"]: one["role"] for one in shown["columns"]}
    assert {word.split(" ")[0] for word in roles.values() if word} >= {"reading", "direction"}
    assert [name for name, role in roles.items() if role is None] in ([], ["column_1"])


def test_an_angle_off_the_axis_under_the_name_elevation_is_found() -> None:
    table = read_table(CASES / "boresight-row-elevation.csv")
    stated = guess(table)
    found = [one for one in findings(readings_of(table, stated), stated) if one.about == "angles"]
    assert [one.change for one in found] == [{"direction": {"form": "azimuth-zenith"}}]
    assert found[0].certain
    turned = stated.model_copy(
        update={"direction": stated.direction.model_copy(update={"form": "azimuth-zenith"})}
    )
    # the row along the boresight counts, and nothing speaks for elevations any more
    every = readings_of(table, turned)
    assert len(every) == len(table)
    assert not [one for one in findings(every, turned) if one.about == "angles"]
