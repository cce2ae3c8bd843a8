"""`cmos-multi-aperture`: a large CMOS pixel array behind a 10 x 10 grid of holes."""

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

_DIAMETER_MM, _FOCAL_MM, _SPACING_MM = 0.16, 1.0, 0.833
#: Every spot is whole on the detector up to here (S-FOV); beyond, fewer are (X-FOV).
_ALL_SPOTS_DEG, _HALF_FOV_DEG = 50.0, 60.0

_SENSOR = MultiSpotSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=grid(10, 10, _SPACING_MM, Aperture("round", _DIAMETER_MM, _DIAMETER_MM), 0.01),
        # the Sun's image is one pixel wide at normal incidence, seven at the field's corners
        sun=SolarDisc(spiral=112),
        assembly=replace(CAREFUL, focal_length_error_mm=0.002),
    ),
    detector=PixelArray(
        columns=1024,
        rows=1024,
        pitch_mm=0.01,
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
_CONDITIONS = pixel_conditions(_SENSOR)

PRESET = FullFramePreset(
    name="cmos-multi-aperture",
    version=1,
    detector="CMOS",
    mask="Multi-Ap.",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 1024, 1024), [sample, row, column]",
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
    directions=AngleField(_HALF_FOV_DEG, steps=9, test_samples=60),
    repeats=FEW,
    follows=("Rufino2009b", "Rufino2012", "Mobasser2003"),
    description=(
        "Full frames of 1024 x 1024 px behind 10 x 10 round holes, the count of Rufino2009b, "
        "which gives no other size in what was mapped. Round numbers: holes of 0.16 mm stand "
        "1 mm up (Fresnel number 12; Mobasser2003 has 0.5 mm), 0.833 mm apart, so that spots of "
        "16 px never touch and no two of a row fall alike on the 10 um pixels. All 100 spots "
        "are whole on the detector up to 50 deg in either angle (S-FOV), 90 of 100 with one "
        "angle and 81 with both at 60 deg, the field's edge (X-FOV). Holes are off by 1 um in "
        "position, 1 um in size (the unit as a whole) and 0.5 um an edge. Few samples, because "
        "a frame is 2 MB. The Sun is sampled at 112 points: pixels are within 0.5 % of peak of a "
        "finer sampling over the whole field."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
        "all_spots_half_fov_deg": _ALL_SPOTS_DEG,
        "some_spots_half_fov_deg": _HALF_FOV_DEG,
    },
)
