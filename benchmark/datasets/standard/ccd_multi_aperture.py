"""`ccd-multi-aperture`: an area CCD behind a foil with some hundred holes."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.full_frames import FullFramePreset, drawn
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, missing_apertures, pixel_conditions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.repeats import FEW
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.masks.layouts import grid
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

_DIAMETER_MM, _FOCAL_MM, _SPACING_MM, _HALF_FOV_DEG = 0.15, 0.9, 0.28, 50.0

_SENSOR = MultiSpotSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=grid(18, 18, _SPACING_MM, Aperture("round", _DIAMETER_MM, _DIAMETER_MM)),
        # the Sun's image is half a pixel wide at normal incidence: few points of it are enough
        sun=SolarDisc(spiral=48),
        assembly=replace(CAREFUL, focal_length_error_mm=0.0018),
    ),
    detector=PixelArray(
        columns=512,
        rows=512,
        pitch_mm=0.015,
        sunlit_e=60_000.0,
        full_well_e=100_000.0,
        prnu=0.01,
        dsnu=0.1,
        dark=DarkCurrent(5_000.0),
        exposure_s=0.01,
        read_noise_e=20.0,
        gain_e_per_dn=30.0,
        offset_dn=16.0,
        bits=12,
    ),
    errors=MaskErrors(position_mm=0.001, size_mm=0.001, edge_mm=0.0005),
)
_CONDITIONS = pixel_conditions(_SENSOR)

PRESET = FullFramePreset(
    name="ccd-multi-aperture",
    version=1,
    detector="CCD",
    mask="Multi-Ap.",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 512, 512), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
        apertures=drawn(_SENSOR.camera.mask),
    ),
    setups={
        **{name: setup for name, setup in _CONDITIONS.items() if name != "hot"},
        "missing-apertures": missing_apertures(_SENSOR),
    },
    directions=AngleField(_HALF_FOV_DEG, steps=6, test_samples=40),
    repeats=FEW,
    follows=("Liebe2001", "Mobasser2001"),
    description=(
        "Full frames of 512 x 512 px behind 18 x 18 round holes. CCD, several hundred holes in "
        "one foil and less than 1 mm from foil to detector are those of Liebe2001 and "
        "Mobasser2001, which give no other size in what was mapped. Round numbers: holes of "
        "0.15 mm stand 0.9 mm up (Fresnel number 11), 0.28 mm apart, so that spots of 10 px "
        "never touch and no two neighbours fall alike on the 15 um pixels. All 324 spots are "
        "whole on the detector over the field of +-50 deg, so that no direction looks like "
        "another one shifted by a hole. Holes are off by 1 um in position, 1 um in size (the "
        "unit as a whole) and 0.5 um an edge; the foil is thin. Pixels are those of "
        "ccd-single-aperture with 1 % gain spread; exposure keeps them below the full well: no "
        "blooming. Few samples, because a frame is 0.5 MB with 324 spots to render. The Sun is "
        "sampled at 48 points: pixels are within 0.5 % of peak of a finer sampling."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
