"""Cameras with a lens that look into the Sun: pixels, conditions, design.

Two kinds: a CCD without drains, whose overflow runs along the columns, and a CMOS array, whose
pixels turn from white to black. A camera's troubles are as large as its own light makes them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from algorithms.contract import Observation, SensorGeometry
from benchmark.datasets.conditions.alignment import MISALIGNED, misalign
from benchmark.datasets.conditions.pixel_arrays import units
from benchmark.datasets.conditions.since_calibration import since_calibration
from benchmark.datasets.fields import AngleField
from benchmark.datasets.preset import Condition, Preset
from benchmark.datasets.repeats import FEW
from benchmark.metrics.bounds import LENS_STEP_RAD
from benchmark.simulator.light.environment import Irradiance
from benchmark.simulator.optics.flare import Aureole, Clouds, Flare, Ghost, Streak
from benchmark.simulator.readout.detectors import DarkCurrent, PixelArray
from benchmark.simulator.readout.pixel_errors import PixelErrors
from benchmark.simulator.sensors.black_sun import BlackSunSensor
from benchmark.simulator.sensors.blooming import BloomingSensor
from benchmark.simulator.sensors.lens_camera import LensCamera

#: Azimuths of the scratches on a dirty window.
_SCRATCHES_DEG = (12.0, 57.0, 101.0, 148.0)

#: Charge that wanders, as of arrays behind masks; webcams' CCDs shift their lines in the dark.
_ERRORS = PixelErrors(crosstalk=0.02)

_LOW_NOISE = "The same camera with a sixth of the read noise and a 12-bit converter."
_CLOUDED = (
    "The nominal camera under broken cloud: six bright patches near the Sun, other ones in every "
    "picture, saturate irregular areas"
)
_CLEAR_SKY = "The bound is that of the clear sky."
_DEAD = "The nominal camera with one pixel in a hundred dead."


def lens_camera(
    *,
    name: str,
    version: int,
    drawn_as: int | None = None,
    detector: str,
    camera: LensCamera,
    half_fov_deg: float,
    setups: Mapping[str, Condition],
    follows: tuple[str, ...],
    description: str,
) -> Preset:
    """Return a dataset of whole frames through a lens."""
    lens, pixels = camera.lens, camera.detector
    f_number = lens.focal_length_mm / lens.pupil_mm
    return Preset(
        name=name,
        version=version,
        drawn_as=drawn_as,
        detector=detector,
        mask="Lens",
        observation=Observation.FRAMES,
        units=f"{units(pixels.columns, pixels.rows)}; whole frames",
        geometry=SensorGeometry(
            focal_length_mm=lens.focal_length_mm,
            pixel_pitch_mm=pixels.pitch_mm,
            centre_px=pixels.centre_px,
            half_fov_deg=half_fov_deg,
            lens_distortion=(lens.k1, lens.k2),
        ),
        setups=setups,
        directions=AngleField(half_fov_deg, steps=9, test_samples=80),
        repeats=FEW,
        batch=8,
        follows=follows,
        description=description,
        regime={
            "propagation": "lens",
            "reason": "the lens's blur of 1 px (standard deviation) contains diffraction: the Airy "
            f"radius at f/{f_number:g} and 550 nm is {1.22 * 0.55 * f_number:.1f} um",
        },
        bound_step_rad=LENS_STEP_RAD,
    )


def ccd(columns: int, pitch_mm: float) -> PixelArray:
    """Return the square CCD of a webcam behind a dark filter: 8 bits."""
    return PixelArray(
        columns=columns,
        rows=columns,
        pitch_mm=pitch_mm,
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
        errors=_ERRORS,
    )


def cmos(columns: int, pitch_mm: float) -> PixelArray:
    """Return the square CMOS array of a micro camera without a filter, exposed for 0.1 ms."""
    return PixelArray(
        columns=columns,
        rows=columns,
        pitch_mm=pitch_mm,
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
        errors=_ERRORS,
    )


def blooming_conditions(camera: LensCamera) -> dict[str, Condition]:
    """Return the conditions of a camera with a CCD without drains."""
    pixels = camera.detector
    glare = Flare(
        aureole=Aureole(0.45, radius_mm=0.06),
        veil=0.1,
        ghosts=(Ghost(0.05, -0.8, 0.15), Ghost(0.05, -0.3, 0.35), Ghost(0.02, 0.5, 0.06)),
        streaks=tuple(Streak(0.03, turn, 0.3, 0.015) for turn in _SCRATCHES_DEG),
    )
    quiet = replace(pixels, read_noise_e=10.0, gain_e_per_dn=10.0, offset_dn=64.0, bits=12)
    loud = replace(pixels, read_noise_e=600.0, gain_e_per_dn=180.0, offset_dn=20.0)
    hot = replace(pixels, dark=replace(pixels.dark, temperature_c=60.0))

    light = Irradiance(stray=0.02, stray_spread=0.004)

    def seen(text: str, through: LensCamera) -> Condition:
        return Condition(text, BloomingSensor(through), light)

    return {
        "nominal": seen(
            "Plain lens: 30 % of the light in an aureole, 5 % veil, two ghosts; read noise of a "
            "third of a digital number, 2 % crosstalk, about 13 dead pixels.",
            camera,
        ),
        "low-noise": seen(_LOW_NOISE, replace(camera, detector=quiet)),
        "high-noise": seen(
            "The same camera with ten times the read noise; the converter's gain and offset are "
            "set so that neither noise nor the full well is clipped.",
            replace(camera, detector=loud),
        ),
        "misaligned": seen(
            f"The nominal camera {MISALIGNED}, focal length 1.7 % long, optical axis three and two "
            "and a half pixels off centre.",
            replace(camera, assembly=misalign(0.05, 0.03, -0.025)),
        ),
        **since_calibration(
            "hot",
            "The nominal camera at 60 deg C: dark current doubles every 7 K",
            BloomingSensor(replace(camera, detector=hot)),
            BloomingSensor(camera),
            light,
        ),
        "glare": seen(_glare(45, 10, "brighter ghosts"), replace(camera, flare=glare)),
        "saturation-clouds": seen(
            f"{_CLOUDED} and bloom too. {_CLEAR_SKY}",
            replace(camera, clouds=Clouds(6, 0.2, (0.04, 0.15), (3.0, 25.0))),
        ),
        "dead-pixels": seen(_DEAD, replace(camera, dead_share=0.01)),
    }


def black_sun(camera: LensCamera) -> dict[str, Condition]:
    """Return the conditions of a camera whose over-saturated pixels are black.

    The reset level is sampled after a tenth of the exposure and gives way beyond a full well.
    """
    pixels = camera.detector
    glare = Flare(
        aureole=Aureole(0.2, radius_mm=0.02),
        veil=0.05,
        ghosts=(Ghost(0.01, -0.9, 0.04), Ghost(0.01, -0.35, 0.09), Ghost(0.006, 0.5, 0.02)),
        streaks=tuple(Streak(0.012, turn, 0.06, 0.004) for turn in _SCRATCHES_DEG),
    )
    quiet = replace(pixels, read_noise_e=5.0, gain_e_per_dn=2.9, offset_dn=64.0, bits=12)
    loud = replace(pixels, read_noise_e=150.0, offset_dn=64.0)
    reset_s, threshold_e = 0.1 * pixels.exposure_s, pixels.full_well_e
    light = Irradiance(stray=2e-4, stray_spread=4e-5)

    def seen(text: str, through: LensCamera) -> Condition:
        return Condition(text, BlackSunSensor(through, reset_s, threshold_e), light)

    return {
        "nominal": seen(
            "Clean lens: 8 % of the light in an aureole, 2 % veil, two faint ghosts; read noise "
            "of 2.6 digital numbers, 2 % crosstalk, about 12 dead pixels.",
            camera,
        ),
        "low-noise": seen(_LOW_NOISE, replace(camera, detector=quiet)),
        "high-noise": seen(
            "The same camera with five times the read noise; the converter's offset is raised so "
            "that noise is not clipped.",
            replace(camera, detector=loud),
        ),
        "misaligned": seen(
            f"The nominal camera {MISALIGNED}, focal length 2.5 % long, optical axis five and four "
            "pixels off centre.",
            replace(camera, assembly=misalign(0.01, 0.015, -0.012)),
        ),
        "glare": seen(
            _glare(20, 5, "brighter ghosts (one of them saturated)"),
            replace(camera, flare=glare),
        ),
        "saturation-clouds": seen(
            f"{_CLOUDED}. {_CLEAR_SKY}",
            replace(camera, clouds=Clouds(6, 0.05, (0.01, 0.05), (0.01, 0.06))),
        ),
        "dead-pixels": seen(_DEAD, replace(camera, dead_share=0.01)),
    }


def _glare(aureole: int, veil: int, ghosts: str) -> str:
    return (
        f"The nominal camera behind a dirty, scratched window: {aureole} % of the light in a wider "
        f"aureole, {veil} % veil, {ghosts}, streaks."
    )
