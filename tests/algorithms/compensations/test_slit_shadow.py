"""Balances behind thick slits: strips of light counted point by point, and the simulated sensor."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.compensations.interference.slit_shadow import SlitShadow
from algorithms.contract import FeatureKind, SensorGeometry
from algorithms.discovery import discover_chains
from algorithms.extractors.currents.photodiode import VoltageBalance
from benchmark import datasets
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.scene import Scene

HEIGHT, THICK, WIDTH = 0.5, 0.1, 2.8
DESIGN = SensorGeometry(
    focal_length_mm=HEIGHT, aperture_width_mm=np.sqrt(2.0) * WIDTH, aperture_shape="square",
    mask_thickness_mm=THICK, slits=((0.0, 45.0, WIDTH), (0.0, -45.0, WIDTH)),
)  # fmt: skip
ANGLES = np.random.default_rng(8).uniform(-58.0, 58.0, (40, 2))


def counted(tangents):
    """Balances (N, 2): points across each slit that pass both rims, on either side of the gap."""
    across = (np.arange(400_000) + 0.5) / 400_000 * 8.0 - 4.0
    found = []
    for x, y in tangents:
        sides = []
        for tangent in ((x + y) / np.sqrt(2.0), (y - x) / np.sqrt(2.0)):
            passed = np.ones(len(across), dtype=bool)
            for height in (HEIGHT - THICK / 2, HEIGHT + THICK / 2):
                passed &= np.abs(across - height * tangent) < WIDTH / 2
            sides += [np.count_nonzero(passed & (across > 0))]
            sides += [np.count_nonzero(passed & (across < 0))]
        q2, q4, q1, q3 = sides
        total = q1 + q2 + q3 + q4
        found.append([(q2 + q3 - q1 - q4) / total, (q1 + q2 - q3 - q4) / total])
    return np.array(found)


def test_strips_counted_point_by_point_are_brought_to_those_of_thin_walls():
    tangents = np.tan(np.radians(ANGLES))
    stage = SlitShadow.for_sensor(DESIGN, FeatureKind.BALANCE)
    seen = counted(tangents)
    found = stage.fit(seen[:1], [[0.0, 0.0, 1.0]]).transform(seen)
    thin = np.sqrt(2.0) * HEIGHT * tangents / WIDTH
    np.testing.assert_allclose(found, thin, atol=2e-5)
    assert np.abs(seen - thin).max() > 0.015


def test_the_simulated_thick_slit_is_inverted_exactly_without_gap_and_errors():
    preset = datasets.get("pd-slit")
    design = preset.geometry_for("thick-slit")
    assert design.mask_thickness_mm == THICK
    sensor = preset.condition("thick-slit").sensor
    camera = replace(sensor.camera, assembly=Assembly(), sun=SolarDisc(diameter_deg=0.0))
    sensor = replace(sensor, camera=camera, pair=replace(sensor.pair, gap_mm=0.0, reach_mm=5.0))
    # as seen, beta goes with x: sun_from_angles takes (alpha, beta)
    sun = sun_from_angles(0.7 * ANGLES)
    light = sensor.lit(Scene(sun, np.ones(len(sun)), np.zeros(len(sun)), None))
    balances = VoltageBalance().extract(light)
    off = {}
    for name in ("spm", "slit-shadow + spm"):
        made = discover_chains()[name].for_sensor(design, FeatureKind.BALANCE)
        off[name] = float(separation_deg(made.fit(balances, sun).predict(balances), sun).max())
    assert off["slit-shadow + spm"] < 1e-4
    assert off["spm"] > 0.5
