"""`cmos-lens`: a micro camera whose Sun is black: CMOS over-saturation inversion."""

from __future__ import annotations

from benchmark.datasets.conditions.alignment import careful_alignment
from benchmark.datasets.conditions.lens_cameras import black_sun, cmos, lens_camera
from benchmark.simulator.optics.flare import Aureole, Flare, Ghost
from benchmark.simulator.optics.lens import Lens
from benchmark.simulator.sensors.lens_camera import LensCamera

_GHOSTS = (Ghost(0.002, -0.9, 0.04), Ghost(0.001, -0.35, 0.09))
_CAMERA = LensCamera(
    lens=Lens(0.4, pupil_mm=0.1, k1=-0.08, k2=0.01),
    detector=cmos(250, 0.003),
    blur_mm=0.003,
    flare=Flare(Aureole(0.08, radius_mm=0.012), veil=0.02, ghosts=_GHOSTS),
    assembly=careful_alignment(0.001, 0.002, -0.0015),
    dead_share=2e-4,
)

PRESET = lens_camera(
    name="cmos-lens",
    version=2,
    detector="CMOS",
    camera=_CAMERA,
    half_fov_deg=40.0,
    setups=black_sun(_CAMERA),
    follows=("Saleem2017", "Saleem2019", "Kim2021"),
    description=(
        "A micro camera without a filter: the Sun is black within a saturated halo. From "
        "Saleem2019: a CMOS chip of 1 mm with 250 x 250 px. Assumed: 3 um pixels, focal "
        "length 0.4 mm with barrel distortion, f/4, exposure 0.1 ms, field +-40 deg. The "
        "middle of the Sun gets 5000 times the full well. The reset level is sampled after a "
        "tenth of the exposure, so pixels with 10 to 20 full wells turn from white to black. "
        "The bound uses pixels that are neither white nor black."
    ),
)
