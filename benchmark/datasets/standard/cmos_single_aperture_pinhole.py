"""`cmos-single-aperture-pinhole`: a CMOS pixel array behind a hole so small that light bends."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.pixel_arrays import CAREFUL, pixel_conditions
from benchmark.datasets.conditions.uneven_light import UnevenPreset
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.diffraction import SUNLIT_SILICON, propagation
from benchmark.simulator.optics.plates import CoverGlass, Plate
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.diffractive_frames import DiffractiveFrameSensor
from benchmark.simulator.sensors.uneven_frames import UnevenIrradiance

_DIAMETER_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.02, 7.0, 30.0

_SENSOR = DiffractiveFrameSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("round", _DIAMETER_MM, _DIAMETER_MM),)),
        assembly=replace(CAREFUL, focal_length_error_mm=0.014),
    ),
    detector=PixelArray(
        columns=448,
        rows=448,
        pitch_mm=0.024,
        sunlit_e=3_000_000.0,
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
    widest_deg=45.0,
)
# stray light counts in full sunlight on the detector, of which the spot's peak gets 1/180
_LIGHT = Irradiance(stray=2e-5, stray_spread=4e-6)
_UNEVEN = UnevenIrradiance(stray=2e-4, stray_spread=4e-5, slope_spread=5e-5)

PRESET = UnevenPreset(
    name="cmos-single-aperture-pinhole",
    version=1,
    detector="CMOS",
    mask="Single-Ap.",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 64, 64), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_SENSOR.detector.pitch_mm,
        centre_px=_SENSOR.detector.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        **pixel_conditions(_SENSOR, _LIGHT),
        "glass": Condition(
            "The nominal sensor with 0.5 mm of glass (index 1.52) on the detector: refraction "
            "pulls the spot inwards and narrows it.",
            replace(_SENSOR, camera=replace(_SENSOR.camera, glass=CoverGlass((Plate(0.5, 1.52),)))),
            _LIGHT,
        ),
        "stray-gradient": Condition(
            "The nominal sensor under ten times the stray light, which slopes across the detector "
            "by a quarter from the middle to the edge (standard deviation), anew for each sample.",
            _SENSOR,
            _UNEVEN,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Antonello2018",),
    description=(
        "64 x 64 px windows of a 448 x 448 px array behind the one pinhole a mapped study "
        "publishes: 20 um wide, 7 mm above a commercial CMOS detector (Antonello2018). Its Fresnel "
        "number is 0.026: the spot is no image of the hole but its diffraction pattern, 0.47 mm "
        "from dark ring to dark ring at 550 nm, seven times the Sun's image. The study's abstract "
        "gives no pixels and no field. Round numbers: 24 um pixels, so that a window holds the "
        "pattern and its stretching by oblique light; a field of 30 deg an axis (39 deg in the "
        "corners), where it is twice as long; 448 px hold it. No filter: the pattern's peak "
        "has 1/180 of full sunlight, exposed to 17,000 electrons. The foil counts as thin. "
        "Windows are placed from the true spot, rounded, plus a uniform whole offset of up to "
        "8 px an axis."
    ),
    regime=propagation(_SENSOR.camera.mask, _FOCAL_MM, SUNLIT_SILICON),
)
