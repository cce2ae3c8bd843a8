"""`cmos-single-aperture-minidss`: the TNO miniDSS, a chip of 368 x 368 px behind one pinhole."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.fields import AngleField

_SENSOR = pixels.window(
    pixels.hole(0.06, 0.01), 0.9, pixels.cmos(368, 0.0065, sunlit_e=14_000.0), window_px=(32, 32)
)
_SETUPS = pixels.pixel_conditions(_SENSOR)

PRESET = pixels.windows(
    name="cmos-single-aperture-minidss",
    version=1,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={"nominal": _SETUPS["nominal"]},
    geometry=pixels.design(_SENSOR, 51.0, aperture_width_mm=0.06, aperture_shape="round"),
    directions=AngleField(51.0),
    follows=("deBoer2013", "deBoer2017"),
    description=(
        "Windows of 32 x 32 px behind one pinhole. From the survey: a pinhole aperture. From the "
        "miniDSS as a catalogue has it (hardware P17, deBoer2017, the same instrument): 368 x 368 "
        "px of 6.5 um, a field of 102 deg. Assumed: 0.9 mm of height, below the 0.97 mm with which "
        "that field fills the array; a hole of 0.06 mm in a foil of 10 um, which casts a spot "
        "about 10 px wide, as on the chip's predecessor (Xie2010); noise of a CMOS array with 10 "
        "bits. The Fresnel number is 1.8. Windows are off the spot by up to 8 px per axis."
    ),
)
