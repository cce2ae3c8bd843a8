"""What each network is shown and how it is trained; chosen on units that are never scored."""

from __future__ import annotations

from collections.abc import Mapping

from benchmark.learned.centre_training import Plan
from benchmark.learned.centres import Look
from benchmark.learned.training import Recipe

#: By data set. A lens's halo needs a wider window than a hole's spot; of the L the corner of its
#: slits' middle lines is learned, in the whole window.
CENTRES: Mapping[str, Plan] = {
    "cmos-single-aperture": Plan(Look(24, 15), 400, Recipe(24, 8, 6e-3)),
    "cmos-single-aperture-thick": Plan(Look(24, 15), 400, Recipe(24, 8, 6e-3), robust_px=0.02),
    "cmos-l-slit": Plan(Look(48, 0, pool=2), 300, Recipe(16, 8, 6e-3), corner_mm=-0.3),
    "cmos-lens": Plan(Look(48, 25), 250, Recipe(20, 8, 6e-3)),
    "ccd-lens": Plan(Look(32, 9), 250, Recipe(20, 8, 6e-3)),
}
#: Training seeds, where there are more than the first.
SEEDS: Mapping[str, tuple[int, ...]] = {"ccd-lens": (0, 1, 2, 3, 4)}
