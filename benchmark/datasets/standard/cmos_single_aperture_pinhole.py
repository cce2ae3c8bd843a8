"""`cmos-single-aperture-pinhole`: a CMOS pixel array behind a hole so small that light bends."""

from __future__ import annotations

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.conditions.uneven_light import UnevenPreset
from benchmark.datasets.fields import AngleField
from benchmark.simulator.light.environment import Irradiance

_SENSOR = pixels.window(pixels.hole(0.02), 7.0, pixels.cmos(448, 0.024, sunlit_e=3_000_000.0))
# stray light counts in full sunlight on the detector, of which the spot's peak gets 1/180
_LIGHT = Irradiance(stray=2e-5, stray_spread=4e-6)

PRESET = pixels.windows(
    name="cmos-single-aperture-pinhole",
    version=6,
    drawn_as=4,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={
        **pixels.pixel_conditions(_SENSOR, _LIGHT),
        "glass": pixels.glass(_SENSOR, "refraction pulls the spot inwards and narrows it", _LIGHT),
        "stray-gradient": pixels.stray_gradient(_SENSOR, 10.0 * _LIGHT.stray),
    },
    geometry=pixels.design(_SENSOR, 30.0, aperture_width_mm=0.02, aperture_shape="round"),
    directions=AngleField(30.0),
    follows=("Antonello2018",),
    description=(
        "Windows of 64 x 64 px of a 448 x 448 px array behind the one pinhole that a mapped study "
        "publishes: 20 um wide, 7 mm above a commercial CMOS detector (Antonello2018). The "
        "Fresnel number is 0.026: the spot is a diffraction pattern of 0.47 mm between dark "
        "rings, seven times the image of the Sun. Assumed: 24 um pixels, field of 30 deg per "
        "axis, no filter, a thin foil. The peak is 1/180 of full sunlight, exposed to 17,000 "
        "electrons. Windows are off the spot by up to 8 px per axis."
    ),
    kind=UnevenPreset,
)
