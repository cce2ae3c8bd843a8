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
    version=5,
    drawn_as=3,
    detector="CCD",
    mask="Multi-Slit",
    sensor=_SENSOR,
    half_fov_deg=60.0,
    follows=("Tsuno2019", "Kondo2024"),
    description=(
        "A reticle of 16 equally spaced slits over a linear CCD, one per axis (Tsuno2019, "
        "Kondo2024; the survey files them under multi-slit). Period and height are not "
        "published. Assumed: slits of 0.2 mm at a period of 0.4 mm, 1.8 mm above 1024 pixels "
        "of 14 um. The pattern keeps its contrast and stays on the array at 60 deg; its ends "
        "identify the slits, so the phase needs no coarse sensor."
    ),
    more=seen_with(_SENSOR, "albedo-clouds", "ghosts", "stray-gradient"),
    kind=UnevenPreset,
)
