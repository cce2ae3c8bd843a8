"""C14: which of the V-slit's eight parameters are needed, and whether they are enough (Fan2015).

`v-slit` is fitted with some of its parameters held at the design. The survey's six structural ones
are a rotation and a displacement of the line under the mask. The turn about the line itself acts as
one of the head's turns with a displacement; in the model's terms the six are height, both shifts,
deflection, slope and the head's turn about the line. Both of refraction are the glass' thickness
and index. The model's two other turns of the head, which the survey leaves out, are fitted only
where the plot says so. Held at the design, the glass is the drawn one, not none at all.

What is left is compared with the root of summed squares of the bound and of what the calibration's
directions themselves are wrong by.
"""

from __future__ import annotations

import math

from algorithms.extractors.profiles.centroid import ProfileThresholdAverage
from algorithms.models.geometric.v_slit import VSlit
from benchmark.claims.benches import ConditionView, ratio, rms
from benchmark.claims.experiment import Trial
from benchmark.claims.experiments.geometry.partly_fixed import PartlyFixedModel
from benchmark.datasets.standard import ccd_v_slit

STRUCTURE = ("focal_length", "shift_along", "shift_across", "deflection", "slope", "tilt_y")
REFRACTION = ("glass_thickness", "glass_index")
FITTED = {
    "none": (),
    "refraction": REFRACTION,
    "structure": STRUCTURE,
    "all eight": STRUCTURE + REFRACTION,
    "all ten": (*STRUCTURE, "rotation", "tilt_x", *REFRACTION),
}


def trial(number: int) -> Trial:
    """Measure one unit with each set of parameters fitted."""
    seen = ConditionView(ccd_v_slit.PRESET, unit=number)
    kind = ProfileThresholdAverage.about.kind
    model = VSlit.for_sensor(seen.preset.geometry, kind)
    none, refraction, structure, eight, ten = (
        rms(seen.errors(ProfileThresholdAverage, PartlyFixedModel(model, free)))
        for free in FITTED.values()
    )
    unit = ccd_v_slit.PRESET.for_unit(number)
    limit = math.hypot(unit.bound("nominal").rms_deg, unit.reference_error_deg("nominal"))
    values = {
        "needed": ratio(none, eight),
        "refraction": ratio(structure, eight),
        "structure": ratio(refraction, eight),
        "enough": ratio(eight, limit),
    }
    words = tuple(FITTED)
    lines = {
        "v-slit": (words, [none, refraction, structure, eight, ten]),
        "bound and reference": (words, [limit] * len(words)),
    }
    return Trial(values, lines)
