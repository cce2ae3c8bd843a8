"""Designs that implementations of the common suite are built for, and what they read of."""

from __future__ import annotations

import itertools
import math

import numpy as np

FACES = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
PYRAMID = tuple(
    (math.cos(turn) / 2, math.sin(turn) / 2, math.sqrt(0.75))
    for turn in np.linspace(0, 2 * np.pi, 6, endpoint=False).tolist()
)
DIAL = {"code_bits": 5, "code_cell_mm": 0.15, "fine_period_mm": 0.3}
LINE_PIXELS = 60
#: Periodic slits over lines of pixels of 0.05 mm: places, mm.
PERIODIC_SLITS = {
    "reticle": tuple(0.2 * (k - 2.5) for k in range(6)),
    "vernier": tuple(0.16 * (k - 3.5) for k in range(8) if k not in {2, 4}),
}
#: A mask larger than its detector of 100 x 100 px, no part of it like another.
CODED = tuple(
    (0.3 * i + 0.06 * x, 0.3 * j + 0.06 * y, 0.05)
    for (i, j), (x, y) in zip(
        itertools.product(range(-7, 8), repeat=2),
        np.random.default_rng(12).uniform(-1.0, 1.0, (225, 2)).tolist(),
        strict=True,
    )
)
HOLES = ((-0.08, -0.06, 0.05), (0.08, -0.05, 0.05), (-0.07, 0.07, 0.05), (0.09, 0.06, 0.05))
#: A mask of which 46 x 40 px show these four.
WIDE_HOLES = (*HOLES, (-0.6, -0.6, 0.05), (0.6, 0.6, 0.05))
PYRAMIDS = {
    "angular-loss",
    "assembled-faces",
    "dnn",
    "panoramic",
    "panoramic-temperature",
    "pyramidal",
    "pyramidal-constant",
    "sure-faces",
    "temperature",
}
MULTI_SPOT = {"mcam", "fmms", "feic", "weighted-spots", "windowed-array"}
#: A design of which a frame shows some holes; methods that list them.
_LISTED = {"centre_px": (22.5, 19.5), "focal_length_mm": 0.5, "aperture_width_mm": 0.05}
LISTS = {"spot-list", "windowed-list"}
#: Fields in which the sensor differs that one implementation is made for.
OWN_DESIGN = {
    "linear-phase-frame": {"aperture_width_mm": 0.06, "focal_length_mm": 0.5},  # as its samples
    "bscm": {"lens_distortion": (-0.1, 0.02)},
    "hough-lines": {"lens_distortion": (-0.1, 0.02)},
    "hough-circle": {"aperture_shape": "round"},
    "optical": {"cover_glass": ((0.3, 1.5), (0.2, 1.8))},
    "shadow": {"mask_thickness_mm": 0.1},
    "slit-shadow": {
        "mask_thickness_mm": 0.1,
        "slits": ((0.0, 45.0, 0.1), (0.0, -45.0, 0.1)),
    },
    "slit-pairs": {"slits": ((0.0, 45.0, 0.1), (0.0, -45.0, 0.1))},
    "pinhole-shadow": {"mask_thickness_mm": 0.1, "aperture_shape": "round"},
    "escm": {"aperture_width_mm": 0.04},
    "escm-wta": {"aperture_width_mm": 0.04},
    "slit": {"line_axes": ("x", "y"), "slits": ((0.0, 0.0, 0.1),)},
    "multi-slit": {"line_axes": ("y", "x"), "slits": ((-0.6, 0.0, 0.2), (0.7, 0.0, 0.2))},
    "v-slit": {
        "line_axes": ("y",),
        "slits": ((-3.3, 0.0, 0.1), (0.5, 45.0, 0.1)),
    },
    "n-slit": {
        "line_axes": ("y",),
        "slits": ((-3.0, 45.0, 0.1), (0.0, 0.0, 0.1), (3.0, 45.0, 0.1)),
    },
    "camera": {"lens_distortion": (-0.1, 0.02)},
    **{name: _LISTED | {"apertures": WIDE_HOLES} for name in LISTS},
    "line-windows": {"line_axes": ("x", "y"), "slits": ((0.0, 0.0, 0.08),)},
    "spot-array": {"apertures": HOLES},
    **{
        name: {
            "focal_length_mm": 1.0,
            "pixel_pitch_mm": 0.05,
            "centre_px": (29.5, 29.5),
            "line_axes": ("y", "x"),
            "line_pixels": LINE_PIXELS,
            "slits": tuple((place, 0.0, 0.08) for place in places),
        }
        for name, places in PERIODIC_SLITS.items()
    },
    "coded-spacing": {"centre_px": (49.5, 49.5), "apertures": CODED},
    "coded-places": {"centre_px": (49.5, 49.5), "apertures": CODED},
    "coded-correlation": {"centre_px": (49.5, 49.5), "apertures": CODED},
}
