"""`cmos-n-slit`: one linear CMOS pixel array behind three slits in the shape of an N."""

from __future__ import annotations

from algorithms.contract import Observation
from benchmark.datasets.conditions.line_arrays import (
    ASSEMBLED,
    PLATE,
    SLITS_ASSEMBLED,
    conditions,
    design,
    regime,
    units,
)
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.slits import n_slit
from benchmark.simulator.optics.plates import CoverGlass
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.lines import LineSensor

_HALF_FOV_DEG = 64.0
_SENSOR = LineSensor(
    camera=Camera(
        focal_length_mm=1.2,
        mask=n_slit(3.0, 45.0, width_mm=0.17, length_mm=6.0, thickness_mm=0.01),
        # at 64 deg the Sun blurs an edge over tens of pixels: points close enough that the steps
        # they make stay below 0.2 % of the peak
        sun=SolarDisc(rings=(28, 28, 28, 28, 28, 28)),
        glass=CoverGlass((PLATE,)),
        assembly=ASSEMBLED,
    ),
    detector=PixelArray(
        columns=2048,
        rows=1,
        pitch_mm=0.008,
        sunlit_e=40_000.0,
        full_well_e=60_000.0,
        prnu=0.02,
        dsnu=0.2,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=60.0,
        gain_e_per_dn=60.0,
        offset_dn=8.0,
        bits=10,
    ),
    pixel_height_mm=0.2,
    axes=("y",),
    errors=SLITS_ASSEMBLED,
)

PRESET = Preset(
    name="cmos-n-slit",
    version=1,
    detector="CMOS",
    mask="N-Slit",
    observation=Observation.PROFILES,
    units=units(_SENSOR),
    geometry=design(_SENSOR, _HALF_FOV_DEG),
    setups=conditions(_SENSOR, _HALF_FOV_DEG),
    directions=AngleField(_HALF_FOV_DEG),
    follows=("He2013",),
    description=(
        "Both angles from one linear active pixel sensor behind an N of slits; it lies along y: "
        "the middle slit is square to it and gives alpha, both outer ones are slanted and add "
        "beta (model:nslit). Detector, N and the field of +-64 deg on both axes are those of "
        "He2013, and so is refraction among the errors: 0.5 mm of glass of index 1.52 here. The "
        "rest is not given in what was mapped. Round numbers instead: slits of 0.17 mm 1.2 mm "
        "up keep the Fresnel number above 10; a slant of 45 deg makes both angles weigh alike; "
        "3 mm between slits keep the three spots in order over the field; 2048 pixels of 8 um "
        "hold them. Pixels of 60,000 electrons, 2 % gain spread, 60 electrons of read noise, "
        "10 bits: noisier than ccd-n-slit's, as active pixels of 2013 are."
    ),
    regime=regime(_SENSOR),
)
