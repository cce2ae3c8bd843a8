"""`cmos-slit`: a CMOS pixel array behind one slit."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, pixel_conditions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.layouts import slit
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.frames import FrameSensor

_WIDTH_MM, _LENGTH_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.17, 0.72, 1.2, 60.0

_SENSOR = FrameSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=slit(_WIDTH_MM, _LENGTH_MM, rotation_deg=0.1, thickness_mm=0.01),
        sun=SolarDisc(spiral=144),
        assembly=replace(CAREFUL, focal_length_error_mm=0.0024),
    ),
    detector=PixelArray(
        columns=512,
        rows=512,
        pitch_mm=0.012,
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
    window_px=(64, 96),
    window_jitter_px=8,
)
_CONDITIONS = pixel_conditions(_SENSOR)
_INCLINED = replace(
    _SENSOR,
    camera=replace(_SENSOR.camera, mask=slit(_WIDTH_MM, _LENGTH_MM, 5.0, thickness_mm=0.01)),
)

PRESET = Preset(
    name="cmos-slit",
    version=1,
    detector="CMOS",
    mask="Slit",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 96, 64), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_WIDTH_MM,
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        **_CONDITIONS,
        "inclined": Condition(
            "The nominal sensor with its slit turned by 5 deg against the pixel columns.",
            _INCLINED,
            _CONDITIONS["nominal"].irradiance,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Chum2003",),
    description=(
        "64 x 96 px windows (columns x rows) of a 512 x 512 px array behind one slit along y. "
        "Chum2003 is a slit sensor on CCD or CMOS; what was mapped gives no geometry, and its "
        "two lines of pixels are an area array here, so that the slit's ends give the second "
        "angle, less well than its sides give the first. Round numbers: a slit of 0.17 mm by "
        "0.72 mm, 1.2 mm up, keeps the Fresnel number above 10; 12 um pixels make it 14 by "
        "60 px; 512 px hold it at 60 deg. It is drawn turned by 0.1 deg. Windows are placed "
        "from the true spot, rounded, plus a uniform whole offset of up to 8 px an axis."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
