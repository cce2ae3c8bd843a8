"""`cmos-l-slit`: a CMOS pixel array behind two slits at right angles."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, pixel_conditions
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Preset
from benchmark.simulator.light.sun_disc import SolarDisc
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.plates import fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.frames import FrameSensor

_WIDTH_MM, _LENGTH_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.17, 0.57, 1.2, 60.0
#: The slits' middle lines lie at -_LINE_MM; each begins _WEB_MM beyond the other one's near side.
_LINE_MM, _WEB_MM = 0.335, 0.1
_MIDDLE_MM = -_LINE_MM + _WIDTH_MM / 2.0 + _WEB_MM + _LENGTH_MM / 2.0

_SENSOR = FrameSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask(
            (
                Aperture("rectangle", _WIDTH_MM, _LENGTH_MM, x_mm=-_LINE_MM, y_mm=_MIDDLE_MM),
                Aperture("rectangle", _LENGTH_MM, _WIDTH_MM, x_mm=_MIDDLE_MM, y_mm=-_LINE_MM),
            ),
            thickness_mm=0.01,
        ),
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
    window_px=(96, 96),
    window_jitter_px=8,
)

PRESET = Preset(
    name="cmos-l-slit",
    version=1,
    detector="CMOS",
    mask="L-Slit",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 96, 96), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        half_fov_deg=_HALF_FOV_DEG,
        line_axes=("x", "y"),
        slits=((-_LINE_MM, 0.0, _WIDTH_MM),),
        mask_thickness_mm=_SENSOR.camera.mask.thickness_mm,
    ),
    setups=pixel_conditions(_SENSOR),
    directions=AngleField(_HALF_FOV_DEG, steps=13, test_samples=400),
    follows=("Jing2016",),
    description=(
        "96 x 96 px windows of a 512 x 512 px array behind two slits at right angles, one an "
        "axis: the one along y tells x (beta), the one along x tells y (alpha). Slits, pixel "
        "array and windowed read-out are those of Jing2016, which gives no dimensions in what "
        "was mapped. Round numbers: slits of 0.17 mm by 0.57 mm, 1.2 mm up, keep the Fresnel "
        "number above 10; 12 um pixels make them 14 by 48 px; a web of 0.1 mm where the L's "
        "corner would be keeps the foil in one piece; 512 px hold both at 60 deg. Windows are "
        "placed from the true spot, rounded, plus a uniform whole offset of up to 8 px an axis."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_WIDTH_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
