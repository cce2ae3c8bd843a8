"""Rule by which the sparse network and a pipeline meet under faults, older than its outcomes.

On `cmos-encoded` a sparse network (SSCNN) goes straight to two angles. It learns from units 20 to
27 with the faults below in most frames; its settings are chosen on units 40 to 42; units 1 to 5
are scored. The pipeline that leads the record on the standard unit meets it at equal calibration:
both are fitted on the clean calibration poses of the unit that they read, the network's angles
through a homography, and nothing else of the unit is known.

Both read the same frames, 80 a unit, without a fault and under each fault at each strength. Suns
and noise are the same under every fault and strength; directions of lasers, order of holes and
shape of glare are the same at every strength. An answer with a flag is none. The error is the root
mean square over the answers of a unit; a method that answers fewer than 95 % there has none and
loses that unit, on which both are alike if neither has one. Under a fault of one strength the
network wins where the geometric mean over units of its error over the pipeline's is below 1 by
more than 3 % and beyond the scatter of units (5 %), and loses where it is above 1 likewise; else
both are alike. Networks and pipelines meet by the same limits in D09, whose verdict this does not
change. Beside it stand the shares that are answered, and the shares of wrong answers without a
flag: off by more than ten of the method's own clean errors, and off by more than one degree.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

#: The data set.
DATASET = "cmos-encoded"
#: Strengths of each fault: a laser's light, Suns, from a direction drawn as the Sun's; share of the
#: mask's holes that dirt hides; mean light of glare over the detector, Suns.
FAULTS: Mapping[str, tuple[float, ...]] = MappingProxyType(
    {
        "laser": (0.05, 0.1, 0.2, 0.4, 0.8),
        "hidden holes": (0.1, 0.2, 0.3, 0.4, 0.5),
        "glare": (0.03, 0.06, 0.12, 0.25, 0.5),
    }
)
#: Frames of each unit, fault and strength.
FRAMES = 80
#: An answer is far off that is off by more, degrees.
FAR_DEG = 1.0
