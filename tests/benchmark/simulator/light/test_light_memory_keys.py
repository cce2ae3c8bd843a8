"""Whatever changes the light changes the key it is kept under."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmark.datasets import get
from benchmark.seeds import generator
from benchmark.simulator.light.memory import memory
from benchmark.simulator.light.sun_disc import from_angles
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.flare import Flare
from benchmark.simulator.scene import Scene

GREEN = Spectrum((550.0,), (1.0,))
SUN = from_angles(np.array([12.0, -7.0]), np.array([-4.0, 9.0]))
#: Sensor or scene -> the same with one thing another that moves light.
Change = Callable[[Any, Scene], tuple[Any, Scene]]


def detector(**changed: Any) -> Change:
    return lambda sensor, scene: (
        replace(sensor, detector=replace(sensor.detector, **changed)),
        scene,
    )


def sensor(**changed: Any) -> Change:
    return lambda sensor, scene: (replace(sensor, **changed), scene)


def moved(right: int, down: int) -> Change:
    return lambda sensor, scene: (
        sensor,
        replace(scene, origin_px=scene.origin_px + np.array([right, down])),
    )


def turned(sensor: Any, scene: Scene) -> tuple[Any, Scene]:
    return sensor, scene.seen_from(from_angles(np.array([12.0, -7.0]), np.array([-4.0, 9.1])))


def assembled(part: str, **changed: Any) -> Change:
    """A part of the optics, or of the optics' own part, with another dimension."""

    def change(sensor: Any, scene: Scene) -> tuple[Any, Scene]:
        return replace(sensor, **{part: replace(getattr(sensor, part), **changed)}), scene

    return change


CHANGES = {
    "cmos-single-aperture": {
        "sun": turned,
        "window to the right": moved(2, 0),
        "window down": moved(0, 2),
        "wider window": sensor(window_px=(66, 64)),
        "higher window": sensor(window_px=(64, 66)),
        "pitch": detector(pitch_mm=0.011),
        "columns": detector(columns=1030),
        "rows": detector(rows=1030),
    },
    "ccd-slit": {
        "sun": turned,
        "axes": sensor(axes=("y", "x")),
        "one axis": sensor(axes=("x",)),
        "fill": sensor(fill_factor=0.5),
        "height": sensor(pixel_height_mm=0.02),
        "pitch": detector(pitch_mm=0.0145),
        "deflection": assembled("errors", deflection_deg=3.0),
    },
    "event-single-aperture": {
        "sun": turned,
        "pitch": detector(pitch_mm=0.0151),
        "columns": detector(columns=700),
        "rows": detector(rows=500),
    },
    "ccd-lens": {
        "sun": turned,
        "blur": sensor(blur_mm=0.02),
        "pitch": detector(pitch_mm=0.0062),
        "flare": sensor(flare=Flare()),
        "dead pixels that move no light": sensor(dead_share=0.2),
    },
}


@pytest.fixture
def remembering():
    memory.forget()
    yield lambda: memory.cache_for("test")
    memory.forget()


def light(sensor: Any, scene: Scene) -> Any:
    shown = getattr(sensor, "lit", None)
    return shown(scene) if shown is not None else sensor.shares(scene.sun)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "what"),
    [
        pytest.param(name, what, marks=[pytest.mark.slow] * name.startswith("event"))
        for name, changes in CHANGES.items()
        for what in changes
    ],
)
def test_light_kept_for_one_sensor_is_not_given_to_another(name, what, remembering):
    setup = get(name).setups["nominal"]
    origin = setup.sensor.origins(SUN, generator("test", "windows"))
    scene = Scene(SUN, np.ones(2), np.zeros(2), origin)
    shown = setup.sensor.camera if hasattr(setup.sensor.camera, "shares") else setup.sensor
    if hasattr(shown, "spectrum"):
        shown = replace(shown, spectrum=GREEN)  # tables of one colour cost least
    other, seen = CHANGES[name][what](shown, scene)
    alone = light(other, seen)
    remembering()
    first = light(shown, scene)
    np.testing.assert_array_equal(light(other, seen), alone)
    np.testing.assert_array_equal(light(shown, scene), first)
    assert memory.hits > 0
    different = first.shape != alone.shape or not np.array_equal(first, alone)
    assert different is ("no light" not in what), "else the change says nothing of the key"
