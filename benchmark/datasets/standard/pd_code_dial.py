"""`pd-code-dial`: photodiodes behind coarse and fine rows of a code dial, one dial an axis."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.line_arrays import ASSEMBLED, LIGHT, MISASSEMBLED
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.slits import slit_row
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import CurrentReadout, DarkCurrent
from benchmark.simulator.sensors.code_dial import CodeDial, CodeDialSensor

_FOCAL_MM, _WIDTH_MM, _HALF_FOV_DEG = 2.5, 0.32, 60.0
_DIAL = CodeDial(
    bits=5,
    cell_mm=0.32,
    period_mm=0.64,
    track_height_mm=0.25,
    track_pitch_mm=0.3,
    track_error_mm=0.002,
)
_SENSOR = CodeDialSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=slit_row((0.0,), _WIDTH_MM, length_mm=13.0, thickness_mm=0.01),
        # a slit's width evens the disc out: few points of the Sun are enough
        sun=SolarDisc(rings=(8, 12, 16)),
        assembly=ASSEMBLED,
    ),
    dial=_DIAL,
    readout=CurrentReadout(
        sunlit_ua=10.0,
        gain_mismatch=0.01,
        noise_ua=0.005,
        full_scale_ua=12.0,
        bits=14,
        dark=DarkCurrent(0.005),
    ),
    deflection_deg=0.03,
)
_READOUT = _SENSOR.readout

PRESET = Preset(
    name="pd-code-dial",
    version=1,
    detector="PD",
    mask="Encoded",
    observation=Observation.CURRENTS,
    units=(
        "microamperes, float64 (N, 18): of the dial along x five coarse tracks (Gray code, most "
        "significant bit first) and the fine rows F1 to F4, then the same of the dial along y"
    ),
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        aperture_width_mm=_WIDTH_MM,
        half_fov_deg=_HALF_FOV_DEG,
        line_axes=("x", "y"),
        mask_thickness_mm=0.01,
        code_bits=_DIAL.bits,
        code_cell_mm=_DIAL.cell_mm,
        fine_period_mm=_DIAL.period_mm,
    ),
    setups={
        "nominal": Condition(
            "Carefully assembled sensor: tracks within 2 um, 1 % gain mismatch, noise of 5e-4 of "
            "full sunlight; fine rows that pass one harmonic.",
            _SENSOR,
            LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with a tenth of the noise and an 18-bit converter.",
            replace(_SENSOR, readout=replace(_READOUT, noise_ua=0.0005, bits=18)),
            LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with ten times the noise.",
            replace(_SENSOR, readout=replace(_READOUT, noise_ua=0.05)),
            LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, slits 30 um too "
            "high, 50 and -40 um off centre and 0.5 deg askew, tracks within 10 um.",
            replace(
                _SENSOR,
                camera=replace(_SENSOR.camera, assembly=MISASSEMBLED),
                dial=replace(_DIAL, track_error_mm=0.01),
                deflection_deg=0.5,
            ),
            LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K, to a ninth of the "
            "current in full sunlight.",
            replace(
                _SENSOR,
                readout=replace(_READOUT, dark=replace(_READOUT.dark, temperature_c=80.0)),
            ),
            LIGHT,
        ),
        "square-windows": Condition(
            "The nominal sensor with plain windows of half a period as fine rows: all odd "
            "harmonics, so the arc tangent of the fine currents errs periodically.",
            replace(_SENSOR, dial=replace(_DIAL, fine_rows="square")),
            LIGHT,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Fan2013",),
    description=(
        "A slit over a code dial with photodiodes behind its tracks, once an axis: coarse rows "
        "tell the cell, four fine rows in quadrature the phase in it (Fan2013, eq:fourier). The "
        "study gives the principle and the field of +-60 deg; its semi-cylindrical lens, which "
        "keeps rays of the measured plane straight, is left out. No dimensions are given. Round "
        "numbers instead: a 0.32 mm slit 2.5 mm up keeps the Fresnel number above 10; a fine "
        "period of twice the slit's width keeps its contrast at 2/pi; Gray cells of half a "
        "period leave a quarter of it for coarse errors; 32 of them span the field."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) of the slit at normal incidence is above 10; diffraction is "
        "left out",
    },
)
