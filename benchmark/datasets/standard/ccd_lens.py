"""`ccd-lens`: a CCD camera whose saturated Sun spills charge along its columns."""

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
from benchmark.simulator.sensors.blooming import BloomingSensor
from benchmark.simulator.sensors.lens_camera import LensCamera

_FOCAL_MM, _HALF_FOV_DEG = 3.0, 20.0
_K1, _K2 = -0.15, 0.05

_DETECTOR = PixelArray(
    columns=256,
    rows=256,
    pitch_mm=0.01,
    sunlit_e=4_000.0,
    full_well_e=40_000.0,
    prnu=0.01,
    dsnu=0.2,
    dark=DarkCurrent(2_000.0),
    exposure_s=0.01,
    read_noise_e=60.0,
    gain_e_per_dn=167.0,
    offset_dn=8.0,
    bits=8,
)
_CAMERA = LensCamera(
    lens=Lens(_FOCAL_MM, pupil_mm=1.0, k1=_K1, k2=_K2),
    detector=_DETECTOR,
    blur_mm=0.01,
    flare=Flare(
        aureole=Aureole(0.3, radius_mm=0.03),
        veil=0.05,
        ghosts=(Ghost(0.02, -0.8, 0.15), Ghost(0.03, -0.3, 0.35)),
    ),
    assembly=Assembly(
        tilt_x_deg=0.05,
        tilt_y_deg=-0.03,
        rotation_deg=0.05,
        focal_length_error_mm=0.006,
        offset_x_mm=0.007,
        offset_y_mm=-0.005,
    ),
    dead_share=2e-4,
)
_GLARE = Flare(
    aureole=Aureole(0.45, radius_mm=0.06),
    veil=0.1,
    ghosts=(Ghost(0.05, -0.8, 0.15), Ghost(0.05, -0.3, 0.35), Ghost(0.02, 0.5, 0.06)),
    streaks=tuple(Streak(0.03, turn, 0.3, 0.015) for turn in (12.0, 57.0, 101.0, 148.0)),
)
_MISALIGNED = Assembly(
    tilt_x_deg=1.0,
    tilt_y_deg=-0.7,
    rotation_deg=0.5,
    focal_length_error_mm=0.05,
    offset_x_mm=0.03,
    offset_y_mm=-0.025,
)
_SENSOR = BloomingSensor(_CAMERA)
_LIGHT = Irradiance(stray=0.02, stray_spread=0.004)

PRESET = Preset(
    name="ccd-lens",
    version=1,
    detector="CCD",
    mask="Lens",
    observation=Observation.FRAMES,
    units="digital numbers, uint16 (N, 256, 256), [sample, row, column]; whole frames",
    geometry=SensorGeometry(
        focal_length_mm=_FOCAL_MM,
        pixel_pitch_mm=_DETECTOR.pitch_mm,
        centre_px=_DETECTOR.centre_px,
        half_fov_deg=_HALF_FOV_DEG,
        lens_distortion=(_K1, _K2),
    ),
    setups={
        "nominal": Condition(
            "Plain lens: 30 % of the light in an aureole, 5 % veil, two ghosts; read noise of a "
            "third of a digital number, 13 dead pixels or so.",
            _SENSOR,
            _LIGHT,
        ),
        "low-noise": Condition(
            "The same camera with a sixth of the read noise and a 12-bit converter.",
            BloomingSensor(
                replace(
                    _CAMERA,
                    detector=replace(
                        _DETECTOR, read_noise_e=10.0, gain_e_per_dn=10.0, offset_dn=64.0, bits=12
                    ),
                )
            ),
            _LIGHT,
        ),
        "high-noise": Condition(
            "The same camera with ten times the read noise; the converter's gain and offset are "
            "set so that neither noise nor the full well is clipped.",
            BloomingSensor(
                replace(
                    _CAMERA,
                    detector=replace(
                        _DETECTOR, read_noise_e=600.0, gain_e_per_dn=180.0, offset_dn=20.0
                    ),
                )
            ),
            _LIGHT,
        ),
        "misaligned": Condition(
            "The nominal camera tilted by 1.0 and -0.7 deg, turned by 0.5 deg, focal length "
            "1.7 % long, optical axis three and two and a half pixels off centre.",
            BloomingSensor(replace(_CAMERA, assembly=_MISALIGNED)),
            _LIGHT,
        ),
        "hot": Condition(
            "The nominal camera at 60 deg C: dark current doubles every 7 K.",
            BloomingSensor(
                replace(
                    _CAMERA,
                    detector=replace(_DETECTOR, dark=replace(_DETECTOR.dark, temperature_c=60.0)),
                )
            ),
            _LIGHT,
        ),
        "glare": Condition(
            "The nominal camera behind a dirty, scratched window: 45 % of the light in a wider "
            "aureole, 10 % veil, brighter ghosts, streaks.",
            BloomingSensor(replace(_CAMERA, flare=_GLARE)),
            _LIGHT,
        ),
        "saturation-clouds": Condition(
            "The nominal camera under broken cloud: six bright patches near the Sun, other ones "
            "in every picture, saturate irregular areas and bloom too. The bound is that of the "
            "clear sky.",
            BloomingSensor(replace(_CAMERA, clouds=Clouds(6, 0.2, (0.04, 0.15), (3.0, 25.0)))),
            _LIGHT,
        ),
        "dead-pixels": Condition(
            "The nominal camera with one pixel in a hundred dead.",
            BloomingSensor(replace(_CAMERA, dead_share=0.01)),
            _LIGHT,
        ),
    },
    directions=AngleField(_HALF_FOV_DEG, steps=9, test_samples=80),
    repeats=FEW,
    batch=8,
    follows=("Liu2016", "Minor2010", "TrebiOllennu2001"),
    description=(
        "A webcam-like CCD camera behind a dark filter (Minor2010), without anti-blooming drains: "
        "the Sun's overflow runs up and down its columns (Liu2016). Neither gives its geometry in "
        "what was mapped; round numbers instead. 3 mm of focal length with barrel distortion hold "
        "+-20 deg on 256 x 256 pixels of 10 um, the Sun 2.8 px wide; behind the filter its middle "
        "gets some 60 full wells, so that trails are a hundred pixels long and more, as wide as "
        "the blurred Sun. Half of the overflow goes either way; what reaches the end of a "
        "column is lost. The bound is that of the pixels' own charges, cut at the full well, and "
        "the columns' overflows, which make up the picture: pixels under a trail count as if it "
        "did not cover them."
    ),
    regime={
        "propagation": "lens",
        "reason": "the lens's blur of 1 px (standard deviation) contains diffraction: the Airy "
        "radius at f/3 and 550 nm is 2.0 um",
    },
    bound_step_rad=LENS_STEP_RAD,
)
