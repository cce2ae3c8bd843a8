"""`cmos-single-aperture`: a CMOS pixel array behind one round aperture."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.masks.apertures import Aperture, Mask
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.plates import CoverGlass, Plate, fresnel_number
from benchmark.simulator.optics.projection import Camera
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.frames import FrameSensor

_DIAMETER_MM, _FOCAL_MM, _HALF_FOV_DEG = 0.2, 1.2, 60.0

# small errors that remain after careful assembly
_NOMINAL_ASSEMBLY = Assembly(
    tilt_x_deg=0.05,
    tilt_y_deg=-0.03,
    rotation_deg=0.05,
    focal_length_error_mm=0.002,
    offset_x_mm=0.004,
    offset_y_mm=-0.003,
)
_DETECTOR = PixelArray(
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
)
_SENSOR = FrameSensor(
    camera=Camera(
        focal_length_mm=_FOCAL_MM,
        mask=Mask((Aperture("round", _DIAMETER_MM, _DIAMETER_MM),), thickness_mm=0.01),
        assembly=_NOMINAL_ASSEMBLY,
    ),
    detector=_DETECTOR,
)
_LOW_NOISE = replace(
    _SENSOR,
    detector=replace(
        _DETECTOR, sunlit_e=200_000.0, full_well_e=300_000.0, gain_e_per_dn=75.0, bits=12
    ),
)
_HIGH_NOISE = replace(
    _SENSOR,
    detector=replace(_DETECTOR, sunlit_e=4_000.0, read_noise_e=150.0, offset_dn=32.0),
)
_MISALIGNED = replace(
    _SENSOR,
    camera=replace(
        _SENSOR.camera,
        assembly=Assembly(
            tilt_x_deg=1.0,
            tilt_y_deg=-0.7,
            rotation_deg=0.5,
            focal_length_error_mm=0.03,
            offset_x_mm=0.05,
            offset_y_mm=-0.04,
        ),
    ),
)
_HOT = replace(
    _SENSOR, detector=replace(_DETECTOR, dark=replace(_DETECTOR.dark, temperature_c=80.0))
)
_GLASS = replace(_SENSOR, camera=replace(_SENSOR.camera, glass=CoverGlass((Plate(0.5, 1.52),))))
_LIGHT = Irradiance(stray=0.002, stray_spread=0.0004)

PRESET = Preset(
    name="cmos-single-aperture",
    version=1,
    detector="CMOS",
    mask="Single-Ap.",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 64, 64), [sample, row, column]",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_DETECTOR.pitch_mm,
        centre_px=_DETECTOR.centre_px,
        aperture_width_mm=_DIAMETER_MM,
        aperture_shape="round",
        half_fov_deg=_HALF_FOV_DEG,
    ),
    setups={
        "nominal": Condition(
            "Carefully assembled sensor: tilts of hundredths of a degree, focal length 0.2 % "
            "long, 1 % pixel gain spread, read noise of one digital number.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same sensor with ten times the electrons and a 12-bit converter.",
            _LOW_NOISE,
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same sensor with a fifth of the electrons and five times the read noise; the "
            "converter's offset is raised so that noise is not clipped.",
            _HIGH_NOISE,
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal sensor tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length "
            "2.5 % long, aperture four pixels off centre: far above the noise.",
            _MISALIGNED,
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal sensor at 80 deg C: dark current doubles every 7 K.", _HOT, _LIGHT
        ),
        "glass": Condition(
            "The nominal sensor with 0.5 mm of glass (index 1.52) on the detector: refraction "
            "pulls the spot inwards, reflection dims it.",
            _GLASS,
            _LIGHT,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG),
    follows=("Chang2008", "Rufino2017", "Xie2012"),
    description=(
        "64 x 64 px windows of a 512 x 512 px array behind one round hole. The studies followed "
        "give the architecture, no full geometry; the one published pinhole (Antonello2018: "
        "20 um at 7 mm) is diffraction-limited. Round numbers instead: a 0.2 mm hole 1.2 mm up "
        "keeps the Fresnel number at 15; 12 um pixels make the spot 17 px wide, inside the 21 px "
        "regions of windowed centroids (Xie2014); 512 px hold the spot at 60 deg; the foil is "
        "10 um thick. Windows are placed from the true spot, rounded, plus a uniform whole "
        "offset of up to 8 px an axis. The focal length counts to the middle of the foil."
    ),
    regime={
        "propagation": "geometric",
        "fresnel_number": round(fresnel_number(_DIAMETER_MM / 2.0, _FOCAL_MM), 2),
        "wavelength_nm": 550,
        "reason": "a^2 / (lambda h) at normal incidence is above 10; diffraction is left out",
    },
)
