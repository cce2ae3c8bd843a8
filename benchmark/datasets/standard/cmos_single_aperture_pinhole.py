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
    version=4,
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
        "64 x 64 px windows of a 448 x 448 px array behind the one pinhole a mapped study "
        "publishes: 20 um wide, 7 mm above a commercial CMOS detector (Antonello2018). Its Fresnel "
        "number is 0.026: the spot is no image of the hole but its diffraction pattern, 0.47 mm "
        "from dark ring to dark ring at 550 nm, seven times the Sun's image. The study's abstract "
        "gives no pixels and no field. Round numbers: 24 um pixels, so that a window holds the "
        "pattern and its stretching by oblique light; a field of 30 deg an axis (39 deg in the "
        "corners), where it is twice as long; 448 px hold it. No filter: the pattern's peak has "
        "1/180 of full sunlight, exposed to 17,000 electrons. The foil counts as thin. Windows are "
        "placed from the true spot, rounded, plus a uniform whole offset of up to 8 px an axis."
    ),
    kind=UnevenPreset,
)
