"""How each property of the survey's assessment is measured: one table, fixed before the outcomes.

The survey scores 19 methods in 21 properties from what studies say: 2 provides, 1 partly, 0 does
not. Here stands, for every property, the experiment whose outcome is put beside that score, with
the limits between 2, 1 and 0. The limits were written down and committed before any outcome was
looked at, and are not to be moved towards agreement. What no experiment decides says so.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

FULL, PARTLY, NOT = 2, 1, 0

#: Every share of found answers asked for below means this much of them.
FOUND = 0.9


@dataclass(frozen=True)
class Definition:
    """One property, and the experiment for it.

    Attributes
    ----------
    name
        Of the property, as in ``survey_data/feature_assessment.csv``.
    source
        What it is read from: stored ``sweeps`` or ``scores``, or ``times`` of the machine that
        is asked; empty where it is not measured.
    measure
        The quantity in words; where it is not measured, the reason.
    unit
        How the quantity is written.
    full, partly
        Limits for 2 and for 1; beyond the second it is 0.
    larger_is_better
        Whether the quantity must reach the limits from above.
    """

    name: str
    source: str
    measure: str
    unit: str = ""
    full: float = 0.0
    partly: float = 0.0
    larger_is_better: bool = False

    @property
    def measured(self) -> bool:
        """Whether there is an experiment."""
        return bool(self.source)

    def score(self, value: float) -> int:
        """Return 2, 1 or 0 for a measured quantity; NaN (nothing found) is 0."""
        sign = 1.0 if self.larger_is_better else -1.0
        if sign * value >= sign * self.full:
            return FULL
        return PARTLY if sign * value >= sign * self.partly else NOT

    def limits(self) -> str:
        """Say the limits in words."""
        if not self.measured:
            return ""
        how = "at least" if self.larger_is_better else "at most"
        unit = f" {self.unit}" if self.unit else ""
        return f"2: {how} {self.full:g}{unit}; 1: {how} {self.partly:g}{unit}; else 0"


#: Taxonomy masks and detectors of the survey's columns; "other" is every one not named.
MASK_GROUPS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "Pinhole Mask": frozenset({"Single-Ap.", "Multi-Ap."}),
        "Slit Mask": frozenset({"Slit", "L-Slit", "N-Slit", "V-Slit", "Multi-Slit"}),
    }
)
DETECTOR_GROUPS: Mapping[str, frozenset[str]] = MappingProxyType(
    {"CMOS Detector": frozenset({"CMOS"}), "CCD Detector": frozenset({"CCD"})}
)
#: Dataset whose CCD spills charge along its columns.
BLOOMING_DATASET = "ccd-lens"
#: Condition of the datasets whose scores are read.
CONDITION = "nominal"

_APPLIES = (
    "smallest rms error behind the best model, with 90 % found, in the nominal condition of the "
    "data sets with {which}; a method that reads none of them scores 0"
)


def _applies(name: str, which: str) -> Definition:
    # 0.5 deg is where the survey's accuracy class "coarse" ends; 5 deg still points at the Sun.
    return Definition(name, "scores", _APPLIES.format(which=which), "deg", 0.5, 5.0)


_ALL = (
    Definition(
        "Computationally light",
        "times",
        "median over the data sets, in their first condition, of extraction time over the time of "
        "one weighted sum of the same observations in NumPy, both measured side by side on the "
        "machine that is asked (`sunatlas leaderboard times`). A plain first moment is three such "
        "sums. Machines and runs move the ratio by tens of per cent, the limits lie a factor "
        "of ten apart",
        "weighted sums",
        3.0,
        30.0,
    ),
    Definition(
        "No pre-processing",
        "sweeps",
        "rms error on raw observations that stand on a pedestal of half the peak (sweep "
        "`pedestal`, same noise), nothing subtracted before, over that without pedestal; with "
        "90 % found",
        "times",
        1.5,
        5.0,
    ),
    Definition(
        "Algorithmically simple",
        "",
        "simplicity is a judgement about reading and writing the method; lines or operations of "
        "one implementation measure its author",
    ),
    _applies("Pinhole Mask", "one or more apertures"),
    _applies("Slit Mask", "slits of any layout"),
    _applies("Other Mask", "coded masks, lenses or no mask"),
    _applies("CMOS Detector", "a CMOS detector"),
    _applies("CCD Detector", "a CCD detector"),
    _applies("Other Detector", "any other detector"),
    Definition(
        "Feature profile agnostic",
        "sweeps",
        "larger over the smaller of the errors over the bound with a flat and with a Gaussian "
        "profile (sweep `profile`), with 90 % found of both",
        "times",
        1.5,
        3.0,
    ),
    Definition(
        "Feature pattern agnostic",
        "",
        "what a method must be told of the mask's pattern is part of how it is defined; an "
        "experiment over patterns would measure the choice of patterns",
    ),
    Definition(
        "Multi-feature",
        "sweeps",
        "gain in precision from one feature to the most (sweep `features`), over that of "
        "independent features, the root of their number; with 90 % found of the most. A method "
        "that refuses several features scores 0",
        "of the ideal gain",
        0.8,
        0.4,
        larger_is_better=True,
    ),
    Definition(
        "Feature tracking",
        "sweeps",
        "share of a sequence (sweep `tracking`) in which the drifting feature is found within "
        "3 px although a glint of its own shape, half as bright again, stands elsewhere from the "
        "second frame on; a method with a memory of frames is run with it",
        "of the frames",
        0.95,
        0.5,
        larger_is_better=True,
    ),
    Definition(
        "Blooming features",
        "scores",
        "smallest rms error behind the best model, with 90 % found, in the nominal condition of "
        "`ccd-lens`, whose saturated pixels spill along their columns; a method that does not "
        "read it scores 0",
        "deg",
        0.5,
        5.0,
    ),
    Definition(
        "Resolution scaling",
        "sweeps",
        "slope of log(rms error / feature size) against log(feature size in pixels) from least "
        "squares over the sweep `size`: -1 is an error of a fixed share of a pixel, -1.5 that of "
        "the bound of a disc; with 90 % found at each size",
        "",
        -1.0,
        -0.5,
    ),
    Definition(
        "Sub-pixel resolution",
        "sweeps",
        "rms error over all sub-pixel phases (sweep `phase`); rounding to whole pixels leaves "
        "0.289 px; with 90 % found",
        "px",
        0.1,
        0.289,
    ),
    Definition(
        "High precision",
        "sweeps",
        "rms error over the Cramer-Rao bound in the reference setting (sweep `reference`), with "
        "90 % found",
        "times the bound",
        1.5,
        3.0,
    ),
    Definition(
        "Feature location agnostic",
        "sweeps",
        "rms error with the feature anywhere on the detector over that with it within 2 px of the "
        "middle (sweep `location`), with 90 % found of both",
        "times",
        1.5,
        3.0,
    ),
    Definition(
        "Robust to noise",
        "sweeps",
        "lowest peak SNR of the sweep `noise` down to which the error stays within three times the "
        "bound with 90 % found, from the reference setting on downwards",
        "peak SNR",
        5.0,
        20.0,
    ),
    Definition(
        "Noise level agnostic",
        "sweeps",
        "largest over smallest error over the bound for peak SNR 10 to 200 (sweep `noise`), with "
        "90 % found at each",
        "times",
        2.0,
        4.0,
    ),
    Definition(
        "Robust to missing features",
        "sweeps",
        "rms error with a fifth of the features missing (of a single feature: of its pixels dead; "
        "sweep `missing`) over that with all, with 90 % found",
        "times",
        1.5,
        3.0,
    ),
)

#: In the order of the survey's table.
DEFINITIONS: Mapping[str, Definition] = MappingProxyType({d.name: d for d in _ALL})
