"""`cmos-single-aperture-naples`: the one-pinhole prototype before the Naples multi-hole sensor."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.fields import AngleField

_SENSOR = pixels.window(
    pixels.hole(0.15, 0.01), 5.0, pixels.cmos(1024, 0.01, sunlit_e=14_000.0), window_px=(64, 64)
)
_SETUPS = pixels.pixel_conditions(_SENSOR)

PRESET = pixels.windows(
    name="cmos-single-aperture-naples",
    version=1,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={"nominal": _SETUPS["nominal"]},
    geometry=pixels.design(_SENSOR, 40.0, aperture_width_mm=0.15, aperture_shape="round"),
    directions=AngleField(40.0),
    follows=("Rufino2017",),
    description=(
        "Windows of 64 x 64 px behind one pinhole. From Rufino2017's abstract: an active pixel "
        "sensor, a geometric model fitted by least squares and a network. From the group's paper "
        "of 2009 (Rufino2009b): that the earlier prototype has one hole, and 10 bits of its "
        "successor. From Rufino2012, of the successor: a field of 80 deg. Assumed, as no dimension "
        "of the prototype is known: 1024 x 1024 px of 10 um as in cmos-multi-aperture, a hole of "
        "0.15 mm in a foil of 10 um, 5 mm up, where the field fills the array. The Fresnel number "
        "is 2. Windows are off the spot by up to 8 px per axis."
    ),
)
