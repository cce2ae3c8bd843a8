"""`cmos-lens`: a micro camera whose Sun is black: CMOS over-saturation inversion."""

from __future__ import annotations

from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.datasets.repeats import FEW
from benchmark.metrics.bounds import LENS_STEP_RAD
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.assembly import Assembly
from benchmark.simulator.optics.flare import Aureole, Clouds, Flare, Ghost, Streak
from benchmark.simulator.optics.lens import Lens
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.sensors.black_sun import BlackSunSensor
from benchmark.simulator.sensors.lens_camera import LensCamera

_FOCAL_MM, _HALF_FOV_DEG = 0.4, 40.0
_K1, _K2 = -0.08, 0.01

_DETECTOR = PixelArray(
    columns=250,
    rows=250,
    pitch_mm=0.003,
    sunlit_e=500_000.0,
    full_well_e=12_000.0,
    prnu=0.01,
    dsnu=0.1,
    dark=DarkCurrent(2_000.0),
    exposure_s=1e-4,
    read_noise_e=30.0,
    gain_e_per_dn=11.5,
    offset_dn=16.0,
    bits=10,
)
_CAMERA = LensCamera(
    lens=Lens(_FOCAL_MM, pupil_mm=0.1, k1=_K1, k2=_K2),
    detector=_DETECTOR,
    blur_mm=0.003,
    flare=Flare(
        aureole=Aureole(0.08, radius_mm=0.012),
        veil=0.02,
        ghosts=(Ghost(0.002, -0.9, 0.04), Ghost(0.001, -0.35, 0.09)),
    ),
    assembly=Assembly(
        tilt_x_deg=0.05,
        tilt_y_deg=-0.03,
        rotation_deg=0.05,
        focal_length_error_mm=0.001,
        offset_x_mm=0.002,
        offset_y_mm=-0.0015,
    ),
    dead_share=2e-4,
)
_GLARE = Flare(
    aureole=Aureole(0.2, radius_mm=0.02),
    veil=0.05,
    ghosts=(Ghost(0.01, -0.9, 0.04), Ghost(0.01, -0.35, 0.09), Ghost(0.006, 0.5, 0.02)),
    streaks=tuple(Streak(0.012, turn, 0.06, 0.004) for turn in (12.0, 57.0, 101.0, 148.0)),
)
_MISALIGNED = Assembly(
    tilt_x_deg=1.0,
    tilt_y_deg=-0.7,
    rotation_deg=0.5,
    focal_length_error_mm=0.01,
    offset_x_mm=0.015,
    offset_y_mm=-0.012,
)
_SENSOR = BlackSunSensor(_CAMERA, reset_s=1e-5, reset_threshold_e=12_000.0)
_LIGHT = Irradiance(stray=2e-4, stray_spread=4e-5)

PRESET = Preset(
    name="cmos-lens",
    version=1,
    detector="CMOS",
    mask="Lens",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 250, 250), [sample, row, column]; whole frames",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_DETECTOR.pitch_mm,
        centre_px=_DETECTOR.centre_px,
        half_fov_deg=_HALF_FOV_DEG,
        lens_distortion=(_K1, _K2),
    ),
    setups={
        "nominal": Condition(
            "Clean lens: 8 % of the light in an aureole, 2 % veil, two faint ghosts; read noise "
            "of 2.6 digital numbers, 12 dead pixels or so.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same camera with a sixth of the read noise and a 12-bit converter.",
            replace(
                _SENSOR,
                camera=replace(
                    _CAMERA,
                    detector=replace(
                        _DETECTOR, read_noise_e=5.0, gain_e_per_dn=2.9, offset_dn=64.0, bits=12
                    ),
                ),
            ),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same camera with five times the read noise; the converter's offset is raised so "
            "that noise is not clipped.",
            replace(
                _SENSOR,
                camera=replace(
                    _CAMERA, detector=replace(_DETECTOR, read_noise_e=150.0, offset_dn=64.0)
                ),
            ),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal camera tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length "
            "2.5 % long, optical axis five and four pixels off centre.",
            replace(_SENSOR, camera=replace(_CAMERA, assembly=_MISALIGNED)),
            _LIGHT,
        ),
        "glare": Condition(
            "The nominal camera behind a dirty, scratched window: 20 % of the light in a wider "
            "aureole, 5 % veil, brighter ghosts (one of them saturated), streaks.",
            replace(_SENSOR, camera=replace(_CAMERA, flare=_GLARE)),
            _LIGHT,
        ),
        "saturation-clouds": Condition(
            "The nominal camera under broken cloud: six bright patches near the Sun, other ones "
            "in every picture, saturate irregular areas. The bound is that of the clear sky.",
            replace(
                _SENSOR,
                camera=replace(_CAMERA, clouds=Clouds(6, 0.05, (0.01, 0.05), (0.01, 0.06))),
            ),
            _LIGHT,
        ),
        "dead-pixels": Condition(
            "The nominal camera with one pixel in a hundred dead.",
            replace(_SENSOR, camera=replace(_CAMERA, dead_share=0.01)),
            _LIGHT,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG, steps=9, test_samples=80),
    repeats=FEW,
    batch=8,
    follows=("Saleem2017", "Saleem2019", "Kim2021"),
    description=(
        "A micro camera that looks into the Sun without a filter: the Sun's image is black within "
        "a saturated halo. Saleem2019 gives a CMOS chip of 1 mm and 250 x 250 px; its 3 um pixels "
        "make that 0.75 mm of image. The rest is set: 0.4 mm of focal length with barrel "
        "distortion holds +-40 deg on both axes; at f/4 and 0.1 ms the middle of the image gets "
        "some 5000 times the full well. The reset level is sampled after a tenth of the exposure "
        "and gives way beyond one full well of charge, so that pixels with 10 to 20 full wells of "
        "light go from white to black. The bound counts, pixel by pixel, what is neither white "
        "nor black. "
        "Dark current at 0.1 ms is too little at any temperature for a hot condition."
    ),
    regime={
        "propagation": "lens",
        "reason": "the lens's blur of 1 px (standard deviation) contains diffraction: the Airy "
        "radius at f/4 and 550 nm is 2.7 um",
    },
    bound_step_rad=LENS_STEP_RAD,
)
