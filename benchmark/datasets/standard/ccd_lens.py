"""`ccd-lens`: a CCD camera whose saturated Sun spills charge along its columns."""

from __future__ import annotations

from benchmark.datasets.conditions.alignment import careful_alignment
from benchmark.datasets.conditions.lens_cameras import blooming_conditions, ccd, lens_camera
from benchmark.simulator.optics.flare import Aureole, Flare, Ghost
from benchmark.simulator.optics.lens import Lens
from benchmark.simulator.sensors.lens_camera import LensCamera

_GHOSTS = (Ghost(0.02, -0.8, 0.15), Ghost(0.03, -0.3, 0.35))
_CAMERA = LensCamera(
    lens=Lens(3.0, pupil_mm=1.0, k1=-0.15, k2=0.05),
    detector=ccd(256, 0.01),
    blur_mm=0.01,
    flare=Flare(Aureole(0.3, radius_mm=0.03), veil=0.05, ghosts=_GHOSTS),
    assembly=careful_alignment(0.006, 0.007, -0.005),
    dead_share=2e-4,
)

PRESET = lens_camera(
    name="ccd-lens",
    version=3,
    drawn_as=2,
    detector="CCD",
    camera=_CAMERA,
    half_fov_deg=20.0,
    setups=blooming_conditions(_CAMERA),
    follows=("Liu2016", "Minor2010", "TrebiOllennu2001"),
    description=(
        "A CCD camera with a lens behind a dark filter (Minor2010). It has no anti-blooming "
        "drains, so charge of the saturated Sun spills along its columns (Liu2016). Neither "
        "study gives dimensions. Assumed: focal length 3 mm with barrel distortion, 256 x 256 "
        "pixels of 10 um, field +-20 deg. The Sun is 2.8 px wide and 60 times the full well; "
        "trails are 100 px or longer. Half of the overflow goes each way. The bound uses the "
        "charges of all pixels, cut at the full well, and the overflow of each column."
    ),
)
