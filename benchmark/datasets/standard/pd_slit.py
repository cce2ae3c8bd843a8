"""`pd-slit`: two pairs of photodiodes, each pair under a slit."""

from __future__ import annotations

import math
from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.slit_pairs import DiodePair, SlitPairSensor

_SLIT_MM, _LENGTH_MM, _FOCAL_MM, _HALF_FOV_DEG = 2.8, 5.0, 0.5, 60.0

_SENSOR = SlitPairSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("rectangle", _SLIT_MM, _LENGTH_MM),), thickness_mm=0.02),
        # the lit strip's edges stay smooth over millimetres: few points of the Sun are enough
        sun=SolarDisc(rings=(4, 8)),
        assembly=Assembly(
            tilt_x_deg=0.05,
            tilt_y_deg=-0.03,
            rotation_deg=0.05,
            focal_length_error_mm=0.001,
            offset_x_mm=0.004,
            offset_y_mm=-0.003,
        ),
    ),
    pair=DiodePair(reach_mm=2.9, breadth_mm=2.0, gap_mm=0.05),
    readout=CurrentReadout(
        sunlit_ua=250.0,
        gain_mismatch=0.01,
        noise_ua=0.02,
        full_scale_ua=120.0,
        bits=14,
        dark=DarkCurrent(0.02),
    ),
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)


def _at(temperature_c: float) -> SlitPairSensor:
    dark = replace(_SENSOR.readout.dark, temperature_c=temperature_c)
    return replace(_SENSOR, readout=replace(_SENSOR.readout, dark=dark))


PRESET = Preset(
    name="pd-slit",
    version=1,
    detector="PD",
    mask="Slit",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): photodiodes Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), "
    "Q4 (-x, -y); Q2 and Q4 share a slit, Q1 and Q3 the other",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        aperture_width_mm=math.sqrt(2.0) * _SLIT_MM,
        aperture_shape="square",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        "nominal": Condition(
            "Carefully assembled, slits 20 um thick, 50 um gaps, 1 % gain mismatch, noise of "
            "2e-4 of full sunlight.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and an 18-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.002, bits=18)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.2)),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length "
            "2.5 % long, slits 50 and -40 um off centre.",
            replace(
                _SENSOR,
                camera=replace(
                    _SENSOR.camera,
                    assembly=Assembly(
                        tilt_x_deg=1.0,
                        tilt_y_deg=-0.7,
                        rotation_deg=0.5,
                        focal_length_error_mm=0.0125,
                        offset_x_mm=0.05,
                        offset_y_mm=-0.04,
                    ),
                ),
            ),
            _LIGHT,
        ),
        "thick-slit": Condition(
            "The nominal sensor with slits 0.1 mm thick, whose walls shade the strip of light.",
            replace(
                _SENSOR,
                camera=replace(_SENSOR.camera, mask=replace(_SENSOR.camera.mask, thickness_mm=0.1)),
            ),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.", _at(80.0), _LIGHT
        ),
        "cold": Condition("The nominal sensor at -40 deg C: no dark current.", _at(-40.0), _LIGHT),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Chang2006", "Abhilash2014", "Hales2002"),
    description=(
        "Photodiodes under slits, balanced in pairs: the field of +-60 deg and the shade of the "
        "slit's thickness are Chang2006's, two axes on one die Abhilash2014's and Hales2002's. "
        "The lengths and the layout are not in what was mapped. Slits at 45 deg to the axes put "
        "each photodiode into a quadrant, so that the voltage balance gives both axes; the slit's "
        "width times sqrt(2) stands in the geometry as the aperture's width d. Round numbers: "
        "slits 0.5 mm up and 2.8 mm wide keep light on all four photodiodes to 60 deg on both "
        "axes; 5 mm of length keep the slit's ends off them. Of the 250 uA that all light "
        "through the slits would make, the photodiodes catch 100 uA at normal incidence."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_SLIT_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is far above 10; diffraction is left out",
    },
)
