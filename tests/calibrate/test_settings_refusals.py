"""Settings that cannot be are refused by the name of their place, all faults at once."""

from __future__ import annotations

from typing import Any

import pytest

from calibrate.settings import SettingsError, parse_settings, parse_toml

SPOT: dict[str, Any] = {"kind": "spot", "columns": ["x", "y"]}
VECTOR: dict[str, Any] = {"form": "vector", "columns": ["sun_x", "sun_y", "sun_z"]}


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
        ("readings.gain", True, "a valid number .*; got True"),
        ("readings.gain", [1.0, "1.5"], "a valid number; got '1.5'"),
        ("readings.inverted", 1, "a valid boolean; got 1"),
        ("rows.shift", "3", "a valid integer; got '3'"),
        ("certificate.begin", 0, "expected a date, as 2026-11-26; got 0"),
        ("rows.shift", 10_001, "less than or equal to 10000; got 10001"),
        ("bench.floor_deg", INF, "a finite number; got inf"),
        ("sensor.centre_px", [NAN, 0.0], "a finite number; got nan"),
        ("sensor.face_normals", [[0.0, 0.0, 0.0]], "directions; got one of zeros"),
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
    "text",
    [
        *("shift = " + "1" * 19_000, "apply = " + 50_000 * "[", 'source = "\\q"'),
        *("a." * 9_000 + "a = 1", "[" + "'a' . " * 9_000 + "a]", '"a b".' * 20 + "a = 1"),
    ],
)
def test_toml_that_nobody_can_read_is_refused_in_a_sentence(text: str) -> None:
    with pytest.raises(SettingsError, match=r"^a\.toml: .{10,200}$"):
        parse_toml(text, "a.toml")


def test_a_value_or_name_that_cannot_be_shown_whole_is_cut() -> None:
    deep: Any = 1
    for _ in range(3000):
        deep = [deep]
    for value, said in ((16**5000, "got a long int"), (deep, "got a long list"), ("x" * 99, "...")):
        stated = {"readings": SPOT, "direction": VECTOR, "k" * 9000: value}
        with pytest.raises(SettingsError, match=rf"^a\.toml: k{{60}}: .{{10,110}}{said}$"):
            parse_settings(stated, "a.toml")


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
