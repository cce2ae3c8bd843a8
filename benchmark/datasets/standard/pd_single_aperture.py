"""`pd-single-aperture`: four photodiodes on one die under a window in their cover glass."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass, Plate, fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent, Quadrants
from benchmark.simulator.sensors.quadrants import QuadrantSensor

_WIDTH_MM, _GLASS_MM, _HALF_FOV_DEG = 0.8, 0.5, 60.0

_SENSOR = QuadrantSensor(
    camera=Camera(
        focal_length_mm=_GLASS_MM,
        mask=Mask((Aperture("rectangle", _WIDTH_MM, _WIDTH_MM),)),
        # the spot's rim stays smooth over tenths of a millimetre: few points are enough
        sun=SolarDisc(rings=(4, 8)),
        glass=CoverGlass((Plate(_GLASS_MM, 1.52),)),
        assembly=Assembly(
            tilt_x_deg=0.05,
            tilt_y_deg=-0.03,
            rotation_deg=0.05,
            focal_length_error_mm=0.002,
            offset_x_mm=0.002,
            offset_y_mm=-0.0015,
        ),
    ),
    detector=Quadrants(half_width_mm=0.8, gap_mm=0.02),
    readout=CurrentReadout(
        sunlit_ua=100.0,
        gain_mismatch=0.01,
        noise_ua=0.02,
        full_scale_ua=120.0,
        bits=14,
        dark=DarkCurrent(0.02),
    ),
)
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)


def _at(temperature_c: float) -> QuadrantSensor:
    dark = replace(_SENSOR.readout.dark, temperature_c=temperature_c)
    return replace(_SENSOR, readout=replace(_SENSOR.readout, dark=dark))


PRESET = Preset(
    name="pd-single-aperture",
    version=1,
    detector="PD",
    mask="Single-Ap.",
    observation=Observation.CURRENTS,
    units="microamperes, float64 (N, 4): photodiodes Q1 (-x, +y), Q2 (+x, +y), Q3 (+x, -y), "
    "Q4 (-x, -y)",
    geometry=SensorGeometry(
        focal_length_mm=_GLASS_MM,
        aperture_width_mm=_WIDTH_MM,
        aperture_shape="square",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        "nominal": Condition(
            "Glued without tilt to speak of, 2 um of glue, 1 % gain mismatch, noise of 2e-4 of "
            "full sunlight.",
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
            "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, 12 um of glue, "
            "window 20 and -15 um off centre.",
            replace(
                _SENSOR,
                camera=replace(
                    _SENSOR.camera,
                    assembly=Assembly(
                        tilt_x_deg=1.0,
                        tilt_y_deg=-0.7,
                        rotation_deg=0.5,
                        focal_length_error_mm=0.012,
                        offset_x_mm=0.02,
                        offset_y_mm=-0.015,
                    ),
                ),
            ),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.", _at(80.0), _LIGHT
        ),
        "cold": Condition("The nominal sensor at -40 deg C: no dark current.", _at(-40.0), _LIGHT),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Ortega2009", "Ortega2010"),
    description=(
        "Four silicon photodiodes on one die, a metallised cover glass with one window glued on "
        "top, a field of +-60 deg: Ortega2010. Sizes are not in what was mapped; round numbers: "
        "0.5 mm of glass (index 1.52) is also the distance from window to die, and a window of "
        "0.8 mm keeps light on all four photodiodes to 60 deg inside it. The geometry's focal "
        "length is the drawing's; refraction makes it appear shorter by the index near the axis."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _GLASS_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is far above 10; diffraction is left out",
    },
)
