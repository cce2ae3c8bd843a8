"""C02: polynomials blended between rows of a table beside the plain table (He2013).

The quadrant sensor of `qpd-single-aperture` is given the study's field of +-64 degrees: its
aperture comes down from 1 mm to 0.45 mm, so that the balance is not saturated before 65.8 degrees,
and its quadrants grow to hold the light. It is calibrated at every whole degree, as the study's
table is, and given the true directions, so that a node of the table is a pose, or nearly. The plain
table is `lut`, which interpolates between the four nodes around; the other is `lut-polynomial` with
the study's 8th degree. Both choose their smoothing by the same calibration samples, as they ship. A
third line shows the table without smoothing: every node as it was measured.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

from algorithms.extractors.currents.photodiode import VoltageBalance
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.lookup_table import ErrorTable
from benchmark.claims.benches import ConditionView, middles, ratio, rms, rms_within
from benchmark.claims.experiment import Line, Trial
from benchmark.claims.truth import with_true_directions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.datasets.standard import qpd_single_aperture
from benchmark.simulator.sensors.quadrants import QuadrantSensor

HALF_FIELD_DEG = 64.0
HEIGHT_MM = 0.45
HALF_WIDTH_MM = 2.2
DEGREE = 8
#: Weight of roughness that only fills nodes without samples.
NO_SMOOTHING = 1e-3
EDGES_DEG = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 72.0)


def trial(number: int) -> Trial:
    """Measure one unit."""
    seen = ConditionView(with_true_directions(_wide()), unit=number)
    kind = VoltageBalance.about.kind
    table = ErrorTable.for_sensor(seen.preset.geometry, kind)
    rows = BlendedPolynomials.for_sensor(seen.preset.geometry, kind)
    found = {
        "plain table (lut)": seen.errors(VoltageBalance, table),
        "blended polynomials (lut-polynomial)": seen.errors(
            VoltageBalance, replace(rows, degree=DEGREE)
        ),
        "plain table, not smoothed": seen.errors(
            VoltageBalance, replace(table, smoothing=NO_SMOOTHING)
        ),
    }
    places = seen.incidence_deg()
    lines: dict[str, Line] = {
        name: (middles(EDGES_DEG), rms_within(errors, places, EDGES_DEG))
        for name, errors in found.items()
    }
    plain, blended, _ = map(rms, found.values())
    return Trial({"refines": ratio(plain, blended)}, lines)


def _wide() -> Preset:
    """Return the quadrant sensor over the study's field, calibrated at whole degrees."""
    preset = qpd_single_aperture.PRESET
    nominal = preset.setups["nominal"]
    sensor = cast("QuadrantSensor", nominal.sensor)
    camera = replace(sensor.camera, focal_length_mm=HEIGHT_MM)
    detector = replace(sensor.detector, half_width_mm=HALF_WIDTH_MM)
    setup = replace(nominal, sensor=replace(sensor, camera=camera, detector=detector))
    return replace(
        preset,
        name="qpd-single-aperture, +-64 deg",
        setups={"nominal": setup},
        geometry=replace(preset.geometry, focal_length_mm=HEIGHT_MM, half_fov_deg=HALF_FIELD_DEG),
        directions=AngleField(HALF_FIELD_DEG, steps=129, test_samples=2000),
    )
