"""`cmos-single-aperture-micro-dss`: the TU Delft micro-DSS, quadruple sampling and 12 bits."""

from __future__ import annotations

from dataclasses import replace

from benchmark.datasets.conditions import pixel_arrays as pixels
from benchmark.datasets.fields import AngleField

_CHIP = pixels.cmos(512, 0.0065, sunlit_e=8_000.0)  # light gathers behind such a hole
# four samples a reading halve the amplifiers' noise; the converter's steps are a fourth
_SAMPLED = replace(
    _CHIP,
    read_noise_e=_CHIP.read_noise_e / 2.0,
    gain_e_per_dn=_CHIP.gain_e_per_dn / 4.0,
    offset_dn=4.0 * _CHIP.offset_dn,
    bits=12,
)
_SENSOR = pixels.window(pixels.hole(0.06, 0.01), 1.25, _SAMPLED, window_px=(32, 32))
_SETUPS = pixels.pixel_conditions(_SENSOR)

PRESET = pixels.windows(
    name="cmos-single-aperture-micro-dss",
    version=3,
    drawn_as=1,
    detector="CMOS",
    mask="Single-Ap.",
    sensor=_SENSOR,
    setups={name: _SETUPS[name] for name in ("nominal", "hot")},
    geometry=pixels.design(_SENSOR, 51.0, aperture_width_mm=0.06, aperture_shape="round"),
    directions=AngleField(51.0),
    follows=("Xie2012",),
    description=(
        "Windows of 32 x 32 px behind one pinhole. From Xie2012's abstract: an active pixel sensor "
        "read in windows, quadruple sampling against thermal noise. From a catalogue's account of "
        "the chip in Xie2010 (hardware P16): 512 x 512 px, 12 bits, a spot about 10 px wide. From "
        "its successor, the TNO miniDSS (P17): pixels of 6.5 um. Assumed: the field of that "
        "successor, 102 deg; a hole of 0.06 mm in a foil of 10 um, 1.25 mm up, which casts such a "
        "spot and keeps it on the array; 15 electrons of read noise, half of that of the other "
        "CMOS arrays here. The Fresnel number is 1.3. Windows are off the spot by up to 8 px per "
        "axis."
    ),
)
