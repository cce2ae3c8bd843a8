"""`cmos-lens`: a micro camera whose Sun is black: CMOS over-saturation inversion."""

from __future__ import annotations

from benchmark.datasets.conditions.alignment import careful
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
    assembly=careful(0.001, 0.002, -0.0015),
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
        "A micro camera that looks into the Sun without a filter: the Sun's image is black within "
        "a saturated halo. Saleem2019 gives a CMOS chip of 1 mm and 250 x 250 px; its 3 um pixels "
        "make that 0.75 mm of image. The rest is set: 0.4 mm of focal length with barrel "
        "distortion holds +-40 deg on both axes; at f/4 and 0.1 ms the middle of the image gets "
        "some 5000 times the full well. The reset level is sampled after a tenth of the exposure "
        "and gives way beyond one full well of charge, so that pixels with 10 to 20 full wells of "
        "light go from white to black. The bound counts, pixel by pixel, what is neither white nor "
        "black. Dark current at 0.1 ms is too little at any temperature for a hot condition."
    ),
)
