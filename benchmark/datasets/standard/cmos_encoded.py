"""`cmos-encoded`: a small CMOS array under a large mask of coded groups of holes."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.full_frames import FullFramePreset, drawn
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, missing_apertures, pixel_conditions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.repeats import FEW
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.coded import spacing_coded, subfield_pitch_mm
from benchmark.simulator.masks.errors import MaskErrors
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.multi_spot_frames import MultiSpotSensor

_DIAMETER_MM, _FOCAL_MM, _HALF_FOV_DEG, _SUBFIELDS = 0.52, 12.0, 52.5, 13
_FIRST_MM, _STEP_MM = 0.92, 0.022

_SENSOR = MultiSpotSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=spacing_coded(
            _SUBFIELDS,
            pitch_mm=subfield_pitch_mm(_SUBFIELDS, _HALF_FOV_DEG, _FOCAL_MM),
            diameter_mm=_DIAMETER_MM,
            first_mm=_FIRST_MM,
            step_mm=_STEP_MM,
            thickness_mm=0.01,
        ),
        sun=SolarDisc(spiral=288),
        assembly=replace(CAREFUL, focal_length_error_mm=0.024),
    ),
    detector=PixelArray(
        columns=256,
        rows=256,
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
    name="cmos-encoded",
    version=1,
    detector="CMOS",
    mask="Encoded",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 256, 256), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
        apertures=drawn(_SENSOR.camera.mask),
        subfields=_SUBFIELDS,
    ),
    setups={**pixel_conditions(_SENSOR), "missing-apertures": missing_apertures(_SENSOR)},
    directions=AngleField(_HALF_FOV_DEG, steps=13, test_samples=150),
    repeats=FEW,
    follows=("Wei2014", "Wang2015"),
    description=(
        "13 x 13 sub-fields over 105 x 105 deg, each with a group of three holes whose two "
        "spacings name it (Wei2014; sizes as a second code, Wang2015, are `size_coded`). The "
        "studies' sizes are not in what was mapped; here geometric shadows set them. Three "
        "spots, blurred by the Sun, must fit a group of pitch 2 h tan(52.5 deg) / 13 without "
        "touching while the Fresnel number stays above 10: that needs h = 12 mm, holes of "
        "0.52 mm and groups 2.41 mm apart. Spacings are 0.92 mm + 22 um times the sub-field's "
        "number: 1.1 px a step. The detector of 5.12 mm holds at least one whole group wherever "
        "the Sun is, and parts of its neighbours; 256 px of 20 um see what more and smaller "
        "ones would, the Sun's image being 5.6 px wide. It is sampled at 288 points: "
        "pixels are within 0.5 % of peak of a finer sampling up to the field's corners, where "
        "its image is 25 px long."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
