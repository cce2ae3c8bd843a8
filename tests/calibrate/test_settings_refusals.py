"""Settings that cannot be are refused by the name of their place, all faults at once."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from calibrate.settings import SettingsError, parse_settings, parse_toml, read_settings

SPOT: dict[str, Any] = {"kind": "spot", "columns": ["x", "y"]}
VECTOR: dict[str, Any] = {"form": "vector", "columns": ["sun_x", "sun_y", "sun_z"]}
TOML = """\
[readings]
kind = "spot"
columns = ["x", "y"]
[direction]
form = "projection"
columns = ["alpha", "beta"]
"""


@pytest.mark.parametrize(
    ("readings", "said"),
    [
        ({"kind": "quadrants", "columns": ["a", "b"]}, "kind quadrants has 4 columns; got 2"),
        (
            {"kind": "channels", "columns": ["a", "b"]},
            "kind channels has three or more columns; got 2",
        ),
        (SPOT | {"dark": [1.0, 2.0, 3.0]}, "dark must be one number or 2; got 3"),
        (SPOT | {"gain": [1.0]}, "gain must be one number or 2; got 1"),
        (SPOT | {"gain": -1.0}, "gain must be positive; say inverted = true"),
        (SPOT | {"gain": [1.0, 0.0]}, "gain must be positive; say inverted = true"),
    ],
)
def test_readings_that_contradict_themselves_are_refused(
    readings: dict[str, Any], said: str
) -> None:
    with pytest.raises(SettingsError, match=rf"^a\.toml: readings: {said}"):
        parse_settings({"readings": readings, "direction": VECTOR}, "a.toml")


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        ("readings.dark", 1e308, "less than or equal to 1000000000000000 .*; got 1e\\+308"),
        ("readings.dark", [0.0, NAN], "a finite number; got nan"),
        ("readings.gain", INF, "a finite number .*; got inf"),
        ("readings.gain", True, "gain must be no true or false"),
        ("rows.shift", 1e30, "integer.*; got 1e\\+30"),
        ("rows.shift", 10_001, "less than or equal to 10000; got 10001"),
        ("bench.floor_deg", 1e308, "less than or equal to 30; got 1e\\+308"),
        ("bench.floor_deg", INF, "a finite number; got inf"),
        ("sensor.focal_length_mm", INF, "a finite number; got inf"),
        ("sensor.focal_length_mm", True, "focal_length_mm must be no true or false"),
        ("sensor.centre_px", [NAN, 0.0], "a finite number; got nan"),
        ("sensor.face_normals", [[0.0, 0.0, 0.0]], "directions; got one of zeros"),
        ("sensor.face_normals", [[0.0, NAN, 1.0]], "a finite number; got nan"),
        ("direction.light", [0.0, 0.0, 0.0], "light must be a direction; got zeros"),
    ],
)
def test_a_setting_out_of_range_is_refused_by_its_name(place: str, value: Any, said: str) -> None:
    part, name = place.split(".")
    stated: dict[str, Any] = {"readings": SPOT, "direction": VECTOR}
    stated[part] = stated.get(part, {}) | {name: value}
    with pytest.raises(SettingsError, match=rf"^a\.toml: {part}[.:].*{said}"):
        parse_settings(stated, "a.toml")


@pytest.mark.parametrize(
    "text", ["shift = " + "1" * 19_000, "apply = " + 50_000 * "[", 'source = "\\q"']
)
def test_toml_that_nobody_can_read_is_refused_in_a_sentence(text: str) -> None:
    with pytest.raises(SettingsError, match=r"^a\.toml: .{10,200}$"):
        parse_toml(text, "a.toml")


def test_one_reading_is_of_one_axis() -> None:
    with pytest.raises(SettingsError, match=r'with direction\.form = "one-angle"; got vector'):
        parse_settings({"readings": {"kind": "spot", "columns": ["x"]}, "direction": VECTOR}, "a")


@pytest.mark.parametrize(
    ("form", "columns", "wanted"),
    [("vector", ["a", "b"], 3), ("projection", ["a", "b", "c"], 2)],
)
def test_a_form_of_direction_has_its_own_number_of_columns(
    form: str, columns: list[str], wanted: int
) -> None:
    said = f"direction: form {form} has {wanted} columns; got {len(columns)}"
    with pytest.raises(SettingsError, match=said):
        parse_settings(
            {"readings": SPOT, "direction": {"form": form, "columns": columns}}, "config"
        )


def test_every_fault_is_named_on_a_line_of_its_own_and_long_values_are_cut() -> None:
    stated = {
        "readings": SPOT,
        "direction": VECTOR | {"unit": "grad"},
        "bench": {"floor_deg": -1.0},
        "certificate": {"country": "f" * 100},
    }
    with pytest.raises(SettingsError) as refusal:
        parse_settings(stated, "config")
    lines = str(refusal.value).removeprefix("config: ").splitlines()
    assert [line.split(":")[0] for line in lines] == [
        "direction.unit",
        "bench.floor_deg",
        "certificate.country",
    ]
    assert lines[0].endswith("got 'grad'")
    assert lines[1].endswith("got -1.0")
    assert lines[2].endswith("got '" + 56 * "f" + "...")


def test_settings_of_a_file_are_those_it_states(tmp_path: Path) -> None:
    path = tmp_path / "sensor.toml"
    path.write_text(TOML, encoding="utf-8")
    found = read_settings(path)
    assert found.readings.columns == ("x", "y")
    assert found.direction.form == "projection"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[readings\n", r"^sensor\.toml: Expected '\]'"),
        (TOML + "[sun]\n", r"^sensor\.toml: sun: Extra inputs are not permitted; got {}"),
    ],
)
def test_a_file_that_holds_no_settings_is_named(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "sensor.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(SettingsError, match=said):
        read_settings(path)
