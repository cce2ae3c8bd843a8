"""`ccd-periodic`: two linear CCDs at right angles, a periodic reticle of 16 slits over each."""

from __future__ import annotations

from benchmark.datasets.conditions.line_arrays import SUN, behind, ccd, line_arrays
from benchmark.datasets.conditions.other_light import seen_with
from benchmark.datasets.conditions.uneven_light import UnevenPreset
from benchmark.simulator.masks.slits import periodic

_MASK = periodic(16, 0.4, width_mm=0.2, length_mm=8.0, thickness_mm=0.0)
_SENSOR = behind(_MASK, 1.8, ccd(1024, 0.014), sun=SUN)

PRESET = line_arrays(
    name="ccd-periodic",
    version=3,
    detector="CCD",
    mask="Multi-Slit",
    sensor=_SENSOR,
    half_fov_deg=60.0,
    follows=("Tsuno2019", "Kondo2024"),
    description=(
        "A reticle of 16 equally spaced slits over a linear CCD (Tsuno2019, Kondo2024), once an "
        "axis. The taxonomy value is the one the survey files these studies under. Period and "
        "height are not given. Round numbers instead: a half-open reticle in a metal film, slits "
        "of 0.2 mm at twice that period, which the Sun's disc and diffraction leave a contrast at "
        "60 deg, 1.8 mm up; 1024 pixels of 14 um hold the whole pattern at 60 deg, so its ends "
        "tell which slit is which and the phase needs no coarse sensor."
    ),
    more=seen_with(_SENSOR, "albedo-clouds", "ghosts", "stray-gradient"),
    kind=UnevenPreset,
)
