"""`psd-single-aperture`: a two-axis position-sensitive device behind a sharp round aperture."""

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
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.position_sensitive import LateralEffect, PositionSensor

_DIAMETER_MM, _FOCAL_MM, _LENGTH_MM, _HALF_FOV_DEG = 0.3, 2.2, 9.0, 60.0

_SENSOR = PositionSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("round", _DIAMETER_MM, _DIAMETER_MM),)),
        # currents are smooth in the spot's place: few points of the Sun are enough
        sun=SolarDisc(rings=(4, 8)),
        assembly=Assembly(
            tilt_x_deg=0.05,
            tilt_y_deg=-0.03,
            rotation_deg=0.05,
            focal_length_error_mm=0.004,
            offset_x_mm=0.01,
            offset_y_mm=-0.008,
        ),
    ),
    detector=LateralEffect(_LENGTH_MM, nonlinearity=0.01),
    readout=CurrentReadout(
        sunlit_ua=50.0,
        gain_mismatch=0.005,
        noise_ua=0.005,
        full_scale_ua=60.0,
        bits=14,
        dark=DarkCurrent(0.005),
    ),
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)


def _at(temperature_c: float) -> PositionSensor:
    dark = replace(_SENSOR.readout.dark, temperature_c=temperature_c)
    return replace(_SENSOR, readout=replace(_SENSOR.readout, dark=dark))


PRESET = Preset(
    name="psd-single-aperture",
    version=1,
    detector="PSD",
    mask="Single-Ap.",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): corner electrodes Q1 (-x, +y), Q2 (+x, +y), "
    "Q3 (+x, -y), Q4 (-x, -y)",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        aperture_width_mm=_LENGTH_MM,
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        "nominal": Condition(
            "Position non-linearity of 1 % at the middle of an edge, amplifiers matched to "
            "0.5 %, noise of 1e-4 of full sunlight an electrode.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and an 18-bit converter.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.0005, bits=18)),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.",
            replace(_SENSOR, readout=replace(_SENSOR.readout, noise_ua=0.05)),
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
                        focal_length_error_mm=0.055,
                        offset_x_mm=0.05,
                        offset_y_mm=-0.04,
                    ),
                ),
            ),
            _LIGHT,
        ),
        "linear": Condition(
            "The nominal sensor with a device that is linear in position.",
            replace(_SENSOR, detector=LateralEffect(_LENGTH_MM)),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.", _at(80.0), _LIGHT
        ),
        "cold": Condition("The nominal sensor at -40 deg C: no dark current.", _at(-40.0), _LIGHT),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Lin2016",),
    description=(
        "One aperture over a position-sensitive device with electrodes at its corners, so that "
        "the voltage balance of quadrants gives both positions: a balance S is a spot at S L / 2, "
        "and the active length L = 9 mm stands in the geometry as the aperture's width d. Lin2016 "
        "gives a pinhole, a 120 x 120 deg field and an aperture of V-shaped cross-section, here "
        "an edge without thickness; no lengths in what was mapped. Round numbers: 9 mm is a "
        "common size of such devices; an aperture 2.2 mm up keeps the spot on it to 60 deg on "
        "both axes, misaligned too; 0.3 mm of diameter keep the Fresnel number above 10."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
