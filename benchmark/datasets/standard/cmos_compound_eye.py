"""`cmos-compound-eye`: a CMOS array under a lensless compound eye of coded sub-eyes."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.cone import ConeField
from benchmark.datasets.conditions.full_frames import FullFramePreset, drawn
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, missing_apertures, pixel_conditions
from benchmark.datasets.repeats import FEW
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.coded import compound_eye
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

_DIAMETER_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.52, 12.0, 60.0
_APERTURES, _RINGS, _PITCH_MM, _CODE_MM = 1026, 3, 1.31, 0.05

_SENSOR = MultiSpotSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=compound_eye(
            _APERTURES,
            _RINGS,
            pitch_mm=_PITCH_MM,
            diameter_mm=_DIAMETER_MM,
            code_mm=_CODE_MM,
            focal_length_mm=_FOCAL_MM,
            thickness_mm=0.01,
        ),
        sun=SolarDisc(spiral=256),
        assembly=replace(CAREFUL, focal_length_error_mm=0.024),
    ),
    detector=PixelArray(
        columns=192,
        rows=192,
        pitch_mm=0.02,
        sunlit_e=20_000.0,
        full_well_e=30_000.0,
        prnu=0.01,
        dsnu=0.1,
        dark=DarkCurrent(2_000.0),
        exposure_s=0.01,
        read_noise_e=30.0,
        gain_e_per_dn=30.0,
        offset_dn=8.0,
        bits=10,
    ),
    errors=MaskErrors(position_mm=0.001, size_mm=0.001, edge_mm=0.0005),
)

PRESET = FullFramePreset(
    name="cmos-compound-eye",
    version=1,
    detector="CMOS",
    mask="Encoded",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 192, 192), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
        apertures=drawn(_SENSOR.camera.mask),
    ),
    setups={**pixel_conditions(_SENSOR), "missing-apertures": missing_apertures(_SENSOR)},
    directions=ConeField(_HALF_FOV_DEG, calibration_samples=150, test_samples=150),
    repeats=FEW,
    follows=("Zhang2021", "Zhang2022a"),
    description=(
        "A round pattern of 1026 holes of varying size in 37 sub-eyes over a cone of 120 deg, "
        "the counts and field of Zhang2021 and Zhang2022a; their sizes are not in what was "
        "mapped. As in cmos-encoded, geometric shadows ask for h = 12 mm and holes of 0.52 mm, "
        "growing outwards with the slant ray. A triangular lattice of 1.31 mm lets 1026 holes "
        "cover what a detector of 3.84 mm sees over the whole cone; each is moved by 50 um in a "
        "direction drawn for its sub-eye, so that the pattern seen tells the sub-eye. The Sun "
        "is sampled at 256 points: pixels are within 0.5 % of peak of a finer sampling."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
