"""What a mission does to a sensor, each effect by itself against a closed form."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from benchmark import datasets
from benchmark.datasets.conditions.mission import FLIGHT, with_flight
from benchmark.datasets.preset import Preset
from benchmark.simulator.flight.dust import dust_shift_mm
from benchmark.simulator.flight.mission import EFFECTS, LEVELS, MOMENTS, Lifetime, Mission, Moment
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.frames import FrameSensor

TILTS_DEG = np.radians([[0.0, 0.0], [20.0, -10.0], [-35.0, 40.0]])


def suns() -> np.ndarray:
    """(N, 3) Suns of some tangents (tan beta, tan alpha)."""
    tangents = np.tan(TILTS_DEG)
    found = np.column_stack([tangents, np.ones(len(tangents))])
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def camera() -> tuple[Camera, FrameSensor]:
    """Return an ideal pinhole over pixels, and its sensor."""
    sensor = datasets.get("cmos-single-aperture").setups["nominal"].sensor
    assert isinstance(sensor, FrameSensor)
    still = dataclasses.replace(sensor.camera, assembly=type(sensor.camera.assembly)())
    return still, dataclasses.replace(sensor, camera=still)


def only(effect: str, **amounts: object) -> Mission:
    """Return a mission of one effect."""
    return dataclasses.replace(Mission().alone(effect), **amounts)


def test_a_mask_that_shifted_moves_the_spot_by_the_shift() -> None:
    pinhole, sensor = camera()
    moment = Moment(25.0, 0.0, shift_mm=(3e-4, -2e-4, 0.0))
    moved = pinhole.spot_mm(moment.seen(suns(), sensor)) - pinhole.spot_mm(suns())
    np.testing.assert_allclose(moved, np.tile([3e-4, -2e-4], (3, 1)), rtol=1e-9)
    # so that the first error of a direction is the shift over the height
    error = np.degrees(np.arccos((moment.seen(suns(), sensor)[0] * suns()[0]).sum()))
    assert error == pytest.approx(math.degrees(math.hypot(3e-4, 2e-4) / 0.75), rel=1e-4)


def test_a_spacer_moves_the_spot_by_its_expansion_times_height_times_tangent() -> None:
    pinhole, sensor = camera()
    moment = Moment(65.0, 0.0, expansion=40.0 * 23e-6)
    moved = pinhole.spot_mm(moment.seen(suns(), sensor)) - pinhole.spot_mm(suns())
    np.testing.assert_allclose(
        moved, 40.0 * 23e-6 * 0.75 * np.tan(TILTS_DEG), rtol=1e-9, atol=1e-15
    )


def test_a_head_that_turned_is_wrong_by_the_turn() -> None:
    _, sensor = camera()
    ahead = np.array([[0.0, 0.0, 1.0]])
    seen = Moment(25.0, 0.0, turn_deg=(0.004, 0.003, 0.0)).seen(ahead, sensor)
    assert np.degrees(np.arccos(seen[0, 2])) == pytest.approx(0.005, rel=1e-3)


@pytest.mark.parametrize(
    ("effect", "name", "amount", "size"),
    [
        ("launch", "launch_shift_um", 0.3, lambda m: 1e3 * m.shift_mm[0]),
        ("launch", "launch_height_um", 0.15, lambda m: 1e3 * m.shift_mm[2]),
        ("heat", "shift_nm_k", 10.0, lambda m: 1e6 * m.shift_mm[0] / (m.temperature_c - 25.0)),
        ("heat", "tilt_mdeg_k", 0.2, lambda m: 1e3 * m.turn_deg[0] / (m.temperature_c - 25.0)),
        ("mount", "mount_deg", 0.005, lambda m: m.turn_deg[2]),
        ("timing", "latency_ms", 1.0, lambda m: 1e3 * m.turn_deg[0] / 0.5),
        ("sunspots", "sunspot_deg", 3e-4, lambda m: m.turn_deg[1]),
    ],
)
def test_what_is_drawn_has_its_amount_as_standard_deviation(effect, name, amount, size) -> None:
    found = [size(only(effect).lifetime("drawn", unit).moments[0]) for unit in range(1500)]
    assert getattr(Mission(), name) == amount
    assert np.std(found) == pytest.approx(amount, rel=0.08)
    assert abs(np.mean(found)) < 4.0 * amount / math.sqrt(len(found))


def test_dust_moves_the_light_by_its_shift_to_a_side_of_the_unit() -> None:
    _, sensor = camera()
    lifetimes = [only("dust").lifetime("a unit", unit) for unit in range(200)]
    sides = np.array([one.at(Moment(25.0, 0.0), sensor).shift_mm[:2] for one in lifetimes])
    np.testing.assert_allclose(np.hypot(*sides.T), dust_shift_mm(sensor, 0.01), rtol=1e-12)
    assert np.abs(sides.mean(axis=0)).max() < 0.2 * dust_shift_mm(sensor, 0.01)


def test_gains_turn_a_direction_as_the_closed_form_of_three_faces() -> None:
    preset = datasets.get("pd-maskless-cube")
    nominal = preset.setups["nominal"]
    sensor = dataclasses.replace(nominal.sensor, response="cosine", normal_error_deg=0.0)
    pattern = {**sensor.fixed_pattern("a", "unit"), "gain": np.ones(6)}
    lifetime = only("gains").lifetime("a unit")
    moment = Moment(45.0, 2.0)
    changed = lifetime.pattern(pattern, moment)["gain"]
    sun = np.array([0.6, 0.48, 0.64])
    lit = np.array([0, 2, 4])
    # readings of faces at right angles are the components of the direction
    answer = sun * changed[lit]
    angle = np.degrees(np.arccos(answer @ sun / np.linalg.norm(answer)))
    gain = changed[lit] - 1.0
    across = gain * sun - sun * (sun @ (gain * sun))
    assert angle == pytest.approx(np.degrees(np.linalg.norm(across)), rel=0.02)
    drawn = [
        only("gains").lifetime("u", unit).pattern(pattern, moment)["gain"] - 1.0
        for unit in range(500)
    ]
    expected = math.hypot(2e-4 * 20.0, 0.01 * 2.0)
    assert np.std(drawn) == pytest.approx(expected, rel=0.05)


def test_dark_signals_double_with_warmth_and_grow_with_dose() -> None:
    sensor = datasets.get("psd-single-aperture").setups["nominal"].sensor
    aged = only("dark").lifetime("a unit").sensor(sensor, Moment(39.0, 0.5))
    first = sensor.readout.dark.level()
    assert aged.readout.dark.level() == pytest.approx(first * 4.0 * (1.0 + 4.0 * 0.5))


def test_a_bent_converter_is_off_by_at_most_its_nonlinearity() -> None:
    _, sensor = camera()
    codes = np.arange(1024, dtype=np.uint16)
    read = only("converter").lifetime("a unit").read(codes, sensor).astype(int)
    off = read - codes
    assert set(np.unique(off)) == {-1, 0, 1}
    assert (read[0], read[-1]) == (0, 1023)
    assert 0.3 < np.mean(off != 0) < 0.75  # a sine is above a half for two thirds of its course


def test_ghosts_are_drawn_evenly_by_their_logarithm() -> None:
    shares = [math.log10(Mission().lifetime("g", unit).ghost) for unit in range(2000)]
    assert min(shares) > math.log10(0.003)
    assert max(shares) < math.log10(0.03)
    assert np.mean(shares) == pytest.approx(math.log10(0.003 * 0.03) / 2.0, abs=0.03)


def test_a_mission_without_effects_leaves_the_sensor_as_it_was() -> None:
    preset = flown("pd-slit", Mission().without(*EFFECTS))
    scene = preset.scene(FLIGHT, "test")
    parts = list(preset.taken(FLIGHT, "test", scene))
    assert sum(len(part) for _, part, _ in parts) == len(scene)
    nominal = preset.setups["nominal"].sensor
    still = preset.fixed_pattern("nominal")
    for sensor, part, pattern in parts:
        np.testing.assert_array_equal(sensor.expected(part, pattern), nominal.expected(part, still))


def test_samples_of_a_flight_are_the_same_however_many_are_made() -> None:
    preset = datasets.get("pd-slit")
    whole, some = preset.generate(FLIGHT, "test"), preset.generate(FLIGHT, "test", 150)
    np.testing.assert_array_equal(whole.observations[:150], some.observations)
    np.testing.assert_array_equal(whole.sun, preset.generate("nominal", "test").sun)


def test_a_unit_has_a_life_of_its_own_and_each_condition_one_of_a_unit() -> None:
    first, other = (datasets.get("cmos-slit").for_unit(unit).lifetime(FLIGHT) for unit in (0, 1))
    assert first is not None
    assert other is not None
    assert {len(life.moments) for life in (first, other)} == {MOMENTS}
    assert first.moments[0].shift_mm != other.moments[0].shift_mm
    ages = [moment.age_years for moment in first.moments]
    assert ages == sorted(ages)
    assert ages[-1] < 2.5
    warmth = sorted(moment.temperature_c for moment in first.moments)
    assert first.eclipse.temperature_c < warmth[MOMENTS // 2]


def test_every_ground_board_flies_and_levels_go_up() -> None:
    for name in datasets.names():
        preset = datasets.get(name)
        assert (FLIGHT in preset.conditions) != bool(preset.context_columns), name
    amounts = [LEVELS[name].launch_shift_um for name in ("benign", "typical", "harsh")]
    assert amounts == sorted(amounts)
    with pytest.raises(ValueError, match="no level 'mild'; there are benign, typical, harsh"):
        with_flight(datasets.get("pd-slit"), "mild")
    with pytest.raises(ValueError, match="no effect 'wind'; there are launch, heat"):
        Mission().alone("wind")


def test_a_card_says_where_each_amount_of_a_mission_comes_from() -> None:
    flight = datasets.get("cmos-slit").card()["conditions"][FLIGHT]
    amounts = flight["parameters"]["mission"]
    assert amounts["launch_shift_um"] == 0.3
    assert flight["sources"].keys() == amounts.keys() - {"type"}
    assert flight["sources"]["launch_shift_um"] == "assumed"
    assert "pd-orbit" in flight["sources"]["gain_per_k"]


def test_dark_readings_of_a_flight_are_those_of_an_eclipse() -> None:
    preset = datasets.get("cmos-slit")
    ground, again = preset.references("nominal"), preset.references(FLIGHT, "test")
    lifetime = preset.lifetime(FLIGHT)
    assert isinstance(lifetime, Lifetime)
    cold = lifetime.sensor(preset.setups["nominal"].sensor, lifetime.eclipse).detector
    # digital numbers: offset and dark signal of the eclipse, as old as then
    expected = cold.offset_dn + cold.dark.level() * cold.exposure_s / cold.gain_e_per_dn
    assert np.median(again["dark_dn"]) == pytest.approx(expected, abs=0.1)
    lit = again["flat_dn"] - again["dark_dn"]
    np.testing.assert_allclose(lit, ground["flat_dn"] - ground["dark_dn"], atol=1e-9)


def flown(name: str, mission: Mission) -> Preset:
    """Return a data set whose flight is this mission without the Earth."""
    preset = datasets.get(name)
    flight = dataclasses.replace(preset.setups[FLIGHT], mission=mission, earth=None)
    return dataclasses.replace(preset, setups={**preset.setups, FLIGHT: flight})
