"""`ccd-single-aperture`: an area CCD behind one square aperture."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, pixel_conditions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.frames import FrameSensor

_WIDTH_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.3, 2.0, 50.0

_SENSOR = FrameSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("rectangle", _WIDTH_MM, _WIDTH_MM, rotation_deg=0.1),), 0.01),
        assembly=replace(CAREFUL, focal_length_error_mm=0.004),
    ),
    detector=PixelArray(
        columns=512,
        rows=512,
        pitch_mm=0.013,
        sunlit_e=60_000.0,
        full_well_e=100_000.0,
        prnu=0.005,
        dsnu=0.1,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=20.0,
        gain_e_per_dn=30.0,
        offset_dn=16.0,
        bits=12,
    ),
    window_px=(64, 64),
    window_jitter_px=8,
)

PRESET = Preset(
    name="ccd-single-aperture",
    version=1,
    detector="CCD",
    mask="Single-Ap.",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 64, 64), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_WIDTH_MM,
        aperture_shape="square",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups=pixel_conditions(_SENSOR),
    directions=AngleField(_HALF_FOV_DEG),
    follows=(),
    description=(
        "64 x 64 px windows of a 512 x 512 px CCD behind one square hole. No mapped study pairs "
        "a CCD with a single aperture; it stands beside cmos-single-aperture to tell the "
        "detector from the mask. Round numbers: 13 um pixels with deep wells (100,000 "
        "electrons), 0.5 % gain spread, 20 electrons of read noise and 12 bits, as area CCDs "
        "have; a 0.3 mm hole 2 mm up has a Fresnel number of 20 and a spot of 23 px, and "
        "512 px hold it at 50 deg. Exposure keeps pixels below the full well: no blooming."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
