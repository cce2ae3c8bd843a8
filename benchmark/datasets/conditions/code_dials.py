"""Photodiodes behind the tracks of a code dial: optics, conditions, design."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import MISALIGNED
from benchmark.datasets.conditions.line_arrays import ASSEMBLED, MISASSEMBLED
from benchmark.datasets.conditions.masked_photodiodes import hot, noises
from benchmark.datasets.conditions.other_light import with_albedo, with_ghosts
from benchmark.datasets.conditions.propagation import LIGHT
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.slits import slit_row
from benchmark.simulator.optics.diffraction import Spectrum
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.sensors.code_dial import CodeDialSensor


def code_dial(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    units: str,
    sensor: CodeDialSensor,
    half_fov_deg: float,
    follows: tuple[str, ...],
    description: str,
) -> Preset:
    """Return a dataset of the currents behind one dial an axis."""
    camera, dial = sensor.camera, sensor.dial
    width_mm = camera.mask.apertures[0].width_mm
    return Preset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector="PD",
        mask="Encoded",
        observation=Observation.CURRENTS,
        units=units,
        geometry=SensorGeometry(
            focal_length_mm=camera.focal_length_mm,
            aperture_width_mm=width_mm,
            half_fov_deg=half_fov_deg,
            line_axes=sensor.axes,
            mask_thickness_mm=camera.mask.thickness_mm,
            code_bits=dial.bits,
            code_cell_mm=dial.cell_mm,
            fine_period_mm=dial.period_mm,
        ),
        setups=conditions(sensor),
        directions=AngleField(half_fov_deg),
        follows=follows,
        description=description,
        regime=_regime(sensor.spectrum),
    )


def _regime(spectrum: Spectrum | None) -> dict[str, Any]:
    """Return how light is propagated to the dial."""
    if spectrum is None:
        return {"propagation": "geometric", "reason": "no spectrum is given"}
    return {
        "propagation": "diffraction",
        "wavelengths_nm": list(spectrum.wavelengths_nm),
        "weights": list(spectrum.weights),
        "reason": "light crosses the borders of coarse cells and square windows as behind "
        "Fresnel's straight edges, over the Sun's disc; geometric currents would miss by 2 % of "
        "full light. Sinusoidal rows stay geometric, and the interference of the slit's two edges "
        "is left out: 0.2 % of full light",
    }


def through_a_slit(width_mm: float, length_mm: float, focal_length_mm: float) -> Camera:
    """Return a carefully assembled slit; its width evens the disc out: few points are enough."""
    return Camera(
        focal_length_mm=focal_length_mm,
        mask=slit_row((0.0,), width_mm, length_mm=length_mm, thickness_mm=0.01),
        sun=SolarDisc(rings=(8, 12, 16)),
        assembly=ASSEMBLED,
    )


def conditions(sensor: CodeDialSensor) -> dict[str, Condition]:
    """Return the conditions of a carefully assembled sensor."""
    dial = sensor.dial
    return {
        "nominal": Condition(
            "Carefully assembled sensor: tracks within 2 um, 1 % gain mismatch, noise of 5e-4 of "
            "full sunlight; fine rows that pass one harmonic.",
            sensor,
            LIGHT,
        ),
        **noises(sensor),
        "misaligned": Condition(
            f"The nominal sensor {MISALIGNED}, slits 30 um too high, 50 and -40 um off centre and "
            "0.5 deg askew, tracks within 10 um.",
            replace(
                sensor,
                camera=replace(sensor.camera, assembly=MISASSEMBLED),
                dial=replace(dial, track_error_mm=0.01),
                deflection_deg=0.5,
            ),
            LIGHT,
        ),
        **hot(sensor, ", to a ninth of the current in full sunlight"),
        "square-windows": Condition(
            "The nominal sensor with plain windows of half a period as fine rows: all odd "
            "harmonics, so the arc tangent of the fine currents has a periodic error.",
            replace(sensor, dial=replace(dial, fine_rows="square")),
            LIGHT,
        ),
        "ghosts": with_ghosts(sensor),
        "albedo": with_albedo(sensor),
    }
