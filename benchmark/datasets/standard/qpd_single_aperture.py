"""`qpd-single-aperture`: a quadrant photodiode behind a square (or round) aperture."""

from __future__ import annotations

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
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent, Quadrants
from benchmark.simulator.sensors.quadrants import QuadrantSensor

_WIDTH_MM, _FOCAL_MM, _HALF_FOV_DEG = 2.0, 1.0, 40.0

_GEOMETRY = SensorGeometry(
    focal_length_mm=_FOCAL_MM,
    aperture_width_mm=_WIDTH_MM,
    aperture_shape="square",
    half_fov_deg=_HALF_FOV_DEG,
)
_SENSOR = QuadrantSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("rectangle", _WIDTH_MM, _WIDTH_MM, rotation_deg=0.1),), 0.02),
        # the spot's rim stays smooth over millimetres: few points of the Sun are enough
        sun=SolarDisc(rings=(4, 8)),
        assembly=Assembly(
            tilt_x_deg=0.05,
            tilt_y_deg=-0.03,
            rotation_deg=0.05,
            focal_length_error_mm=0.002,
            offset_x_mm=0.004,
            offset_y_mm=-0.003,
        ),
    ),
    detector=Quadrants(half_width_mm=1.8, gap_mm=0.05),
    readout=CurrentReadout(
        sunlit_ua=100.0,
        gain_mismatch=0.01,
        noise_ua=0.02,
        full_scale_ua=120.0,
        bits=14,
        dark=DarkCurrent(0.02),
    ),
)
_ROUND = replace(
    _SENSOR,
    camera=replace(
        _SENSOR.camera, mask=Mask((Aperture("round", _WIDTH_MM, _WIDTH_MM),), thickness_mm=0.02)
    ),
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="qpd-single-aperture",
    version=1,
    detector="QPD",
    mask="Single-Ap.",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), Q4 (-x, -y)",
    geometry=_GEOMETRY,
    setups={
        "nominal": Condition(
            "Square aperture, 50 um gap, 1 % gain mismatch, noise of 2e-4 of full sunlight.",
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
            "2.5 % long, aperture 50 and -40 um off centre.",
            replace(
                _SENSOR,
                camera=replace(
                    _SENSOR.camera,
                    assembly=Assembly(
                        tilt_x_deg=1.0,
                        tilt_y_deg=-0.7,
                        rotation_deg=0.5,
                        focal_length_error_mm=0.025,
                        offset_x_mm=0.05,
                        offset_y_mm=-0.04,
                    ),
                ),
            ),
            _LIGHT,
        ),
        "wide-gap": Condition(
            "The nominal sensor with a gap of 0.2 mm, a tenth of the aperture.",
            replace(_SENSOR, detector=replace(_SENSOR.detector, gap_mm=0.2)),
            _LIGHT,
        ),
        "round-aperture": Condition(
            "The nominal sensor behind a round aperture of the same width: the balance is no "
            "longer linear in the tangent.",
            _ROUND,
            _LIGHT,
            geometry=replace(_GEOMETRY, aperture_shape="round"),
        ),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Boslooper2017", "Faizullin2017"),
    description=(
        "Four photodiodes under one aperture: square as in Boslooper2017, round as in "
        "Faizullin2017. Neither gives its geometry in what was mapped; round numbers instead. A "
        "2 mm aperture 1 mm up makes tan(alpha_max) = d / (2 h) = 1 (alg:VB), so the balance "
        "saturates at 45 deg and the field stops at 40 deg; a detector of 3.6 mm cuts the spot "
        "off in the last degree of it (from 38.7 deg), as small detectors do."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is far above 10; diffraction is left out",
    },
)
