"""`pd-code-dial`: photodiodes behind coarse and fine rows of a code dial, one dial an axis."""

from __future__ import annotations

from benchmark.datasets.conditions.code_dials import code_dial, through_a_slit
from benchmark.datasets.conditions.masked_photodiodes import amplifiers
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON
from benchmark.simulator.sensors.code_dial import CodeDial, CodeDialSensor

_DIAL = CodeDial(
    bits=5,
    cell_mm=0.32,
    period_mm=0.64,
    track_height_mm=0.25,
    track_pitch_mm=0.3,
    track_error_mm=0.002,
)
_READOUT = amplifiers(sunlit_ua=10.0, noise_ua=0.005, full_scale_ua=12.0)

PRESET = code_dial(
    name="pd-code-dial",
    version=5,
    drawn_as=3,
    units=(
        "microamperes, float64 (N, 18): of the dial along x five coarse tracks (Gray code, most "
        "significant bit first) and the fine rows F1 to F4, then the same of the dial along y"
    ),
    sensor=CodeDialSensor(
        through_a_slit(0.32, 13.0, 2.5),
        _DIAL,
        _READOUT,
        deflection_deg=0.03,
        spectrum=SUNLIT_SILICON,
    ),
    half_fov_deg=60.0,
    follows=("Fan2013",),
    description=(
        "A slit over a code dial with photodiodes behind its tracks, one per axis: coarse "
        "rows give the cell, four fine rows in quadrature the phase in it (Fan2013, "
        "eq:fourier). From Fan2013: the principle, field +-60 deg; its semi-cylindrical lens "
        "is left out. Assumed: a slit of 0.32 mm, 2.5 mm up; a fine period of twice the "
        "slit's width (contrast 2/pi); 32 Gray cells of half a period."
    ),
)
