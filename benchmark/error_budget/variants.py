"""Names of what is measured again: parts of the chain made perfect, or worse, one at a time."""

from __future__ import annotations

#: What is made perfect by itself, all else as it is.
SINGLE = ("lamp", "calibration_noise", "noise", "references", "fixed_pattern", "surroundings")
#: All of that perfect; then fitted to the test poses as well; the same of the true places.
JOINT = ("perfect", "perfect_dense", "places", "places_dense")
#: What is made worse: directions that benches give, readings without correction.
WORSE = ("bench", "uncorrected")
#: Everything that is scored.
VARIANTS = ("as_is", *WORSE, *SINGLE, *JOINT)
