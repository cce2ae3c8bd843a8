"""How each property of the survey's assessment is judged: one table, fixed before the outcomes.

The survey scores 19 methods in 21 properties from what studies say: 2 provides, 1 partly, 0 does
not. Here stands, for every property, the experiment whose outcome is put beside that score, with
the limits between 2, 1 and 0, and where that outcome can contradict the score at all. What the
table does not mean to say, no measurement opposes: such a cell is "not judged", with the reason.
A method that answers too seldom, or gives up on data it was given, scores 0 with that reason; a
design it was never run on, or a mask for which there is no data set, is no outcome: "not measured".

The limits were written down and committed before any outcome was looked at, and are not to be
moved towards agreement. This is the second version: it was written from the survey's text, knowing
which columns of the first had been found to measure something else, and before its own outcomes
were computed. No limit was moved. Scores have been own errors since: the 0.016 deg that a bench
added to them before decide nothing at limits of 0.5 and 5 deg. `former.csv` keeps what the first
version said.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

FULL, PARTLY, NOT = 2, 1, 0

#: Where an outcome can contradict the survey's score: ``always``; ``claimed``, where the survey
#: scores 1 or 2 (its 0 says that the study did something else, not that the method cannot);
#: ``failed``, where less than 2 is measured (a necessary condition: to pass it proves nothing);
#: ``never``, where nothing that is measured here tells.
Judged = Literal["always", "claimed", "failed", "never"]

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
    judged
        Where an outcome can contradict the survey's score.
    why
        Why it cannot elsewhere; empty where it always can.
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
    judged: Judged = "always"
    why: str = ""
    unit: str = ""
    full: float = 0.0
    partly: float = 0.0
    larger_is_better: bool = False

    @property
    def has_experiment(self) -> bool:
        """Whether there is an experiment."""
        return bool(self.source)

    def score(self, value: float) -> int:
        """Return 2, 1 or 0 for a measured quantity; NaN (nothing found) is 0."""
        sign = 1.0 if self.larger_is_better else -1.0
        if sign * value >= sign * self.full:
            return FULL
        return PARTLY if sign * value >= sign * self.partly else NOT

    def why_undecided(self, survey: int, measured: int | None) -> str:
        """Say why an outcome does not judge the survey's score; empty where it does."""
        if not self.has_experiment:
            return self.measure
        beyond = (self.judged == "claimed" and survey == NOT) or (
            self.judged == "failed" and measured == FULL
        )
        return self.why if beyond else ""

    def limits(self) -> str:
        """Say the limits in words, and where they are no judgement."""
        if not self.has_experiment:
            return ""
        how = "at least" if self.larger_is_better else "at most"
        unit = f" {self.unit}" if self.unit else ""
        said = f"2: {how} {self.full:g}{unit}; 1: {how} {self.partly:g}{unit}; else 0"
        return said + _ONLY[self.judged]


_ONLY: Mapping[Judged, str] = MappingProxyType(
    {
        "always": "",
        "claimed": "; judged where the survey says 2 or 1",
        "failed": "; judged where it is 1 or 0",
        "never": "",
    }
)

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
    "smallest own error (rms) behind the best model, with 90 % found, in the nominal condition of "
    "the data sets with {which}: whether a sensor built as the survey marks it works"
)
_RECORDED = (
    "the survey's table marks the {part} used in the case study of a method. A 0 means that the "
    "study used another {part}, which no measurement can contradict; the measured value is given "
    "for information"
)


def _applies(name: str, part: str, which: str) -> Definition:
    # 0.5 deg is where the survey's accuracy class "coarse" ends; 5 deg still points at the Sun.
    return Definition(
        name,
        "scores",
        _APPLIES.format(which=which),
        "claimed",
        _RECORDED.format(part=part),
        unit="deg",
        full=0.5,
        partly=5.0,
    )


_ALL = (
    Definition(
        "Computationally light",
        "times",
        "median over the data sets, in their first condition, of extraction time over the time of "
        "one weighted sum of the same observations in NumPy, both measured side by side "
        "(`sunatlas leaderboard times`). A plain first moment is three such "
        "sums. Machines and runs move the ratio by tens of per cent, the limits lie a factor "
        "of ten apart",
        unit="weighted sums",
        full=3.0,
        partly=30.0,
    ),
    Definition(
        "No pre-processing",
        "",
        "the survey's table marks methods that are published without pre-processing (its text: "
        "BCM has none, BCTM thresholds, IFM filters, MCAM and DBCM threshold first), which is a "
        "property of the published steps. An outcome does not show which steps lie inside: a "
        "pedestal (sweep `pedestal`) spares methods that remove it themselves, which the table "
        "scores 0, and spoils a plain first moment, which it scores 2",
        "never",
    ),
    Definition(
        "Algorithmically simple",
        "",
        "simplicity is a judgement about reading and writing the method; lines or operations of "
        "one implementation measure its author",
        "never",
    ),
    _applies("Pinhole Mask", "mask", "one or more apertures"),
    _applies("Slit Mask", "mask", "slits of any layout"),
    _applies("Other Mask", "mask", "coded masks, lenses or no mask"),
    _applies("CMOS Detector", "detector", "a CMOS detector"),
    _applies("CCD Detector", "detector", "a CCD detector"),
    _applies("Other Detector", "detector", "any other detector"),
    Definition(
        "Feature profile agnostic",
        "sweeps",
        "larger over the smaller of the errors over the bound with a flat and with a Gaussian "
        "profile (sweep `profile`), with 90 % found of both",
        unit="times",
        full=1.5,
        partly=3.0,
    ),
    Definition(
        "Feature pattern agnostic",
        "",
        "the knowledge of the mask pattern is part of the definition of a method; an "
        "experiment over patterns would measure the choice of patterns",
        "never",
    ),
    Definition(
        "Multi-feature",
        "sweeps",
        "gain in precision from one feature to the most (sweep `features`), over that of "
        "independent features, the root of their number; with 90 % found of the most. A method "
        "that refuses several features scores 0",
        unit="of the ideal gain",
        full=0.8,
        partly=0.4,
        larger_is_better=True,
    ),
    Definition(
        "Feature tracking",
        "sweeps",
        "share of a sequence (sweep `tracking`) in which the drifting feature is found within "
        "3 px although a glint of its own shape, half as bright again, stands elsewhere from the "
        "second frame on; a method with a memory of frames is run with it",
        unit="of the frames",
        full=0.95,
        partly=0.5,
        larger_is_better=True,
    ),
    Definition(
        "Blooming features",
        "scores",
        "smallest own error (rms) behind the best model, with 90 % found, in the nominal condition "
        "of `ccd-lens`, whose saturated pixels spill along their columns",
        "claimed",
        "the survey's table marks methods whose feature is spilt charge (its text: BSCM and BHT "
        "use blooming lines). A 0 means that a method does not use it, which an answer in spite "
        "of blooming does not contradict",
        unit="deg",
        full=0.5,
        partly=5.0,
    ),
    Definition(
        "Resolution scaling",
        "sweeps",
        "slope of log(rms error / feature size) against log(feature size in pixels) from least "
        "squares over the sweep `size`: -1 is an error of a fixed share of a pixel, -1.5 that of "
        "the bound of a disc; with 90 % found at each size",
        unit="",
        full=-1.0,
        partly=-0.5,
    ),
    Definition(
        "Sub-pixel resolution",
        "sweeps",
        "rms error over all sub-pixel phases (sweep `phase`); rounding to whole pixels leaves "
        "0.289 px; with 90 % found",
        unit="px",
        full=0.1,
        partly=0.289,
    ),
    Definition(
        "High precision",
        "sweeps",
        "rms error over the Cramer-Rao bound in the reference setting (sweep `reference`), with "
        "90 % found",
        unit="times the bound",
        full=1.5,
        partly=3.0,
    ),
    Definition(
        "Feature location agnostic",
        "sweeps",
        "error over the bound with the feature anywhere on the detector over that with it within "
        "2 px of the middle (sweep `location`), with 90 % found of both; over the bound, because a "
        "sensor that tells less off its middle is not the method's doing",
        "failed",
        "the survey's table means performance that does not depend on the position of the spot "
        "(its text, of BSCM), on sensors whose spot changes its shape with the angle of "
        "incidence. The reference features look alike wherever they fall: an error that grows "
        "here shows a method that depends on the place, one that does not grow shows nothing. "
        "Rings of the scores hold the model, the geometry and vignetting too",
        unit="times",
        full=1.5,
        partly=3.0,
    ),
    Definition(
        "Robust to noise",
        "sweeps",
        "lowest peak SNR of the sweep `noise` down to which the error stays within three times the "
        "bound with 90 % found, from the reference setting on downwards",
        unit="peak SNR",
        full=5.0,
        partly=20.0,
    ),
    Definition(
        "Noise level agnostic",
        "sweeps",
        "largest over smallest rms error for peak SNR 10 to 200 (sweep `noise`), with 90 % found "
        "at each. The table means a level accuracy (the text: TM's is consistent across noise "
        "levels, that of BCTM and IFM falls as noise rises), so the error itself must be "
        "constant, not its ratio to a bound that grows about twentyfold over these levels. A "
        "method at the bound is therefore not agnostic, one whose error has another cause can be",
        unit="times",
        full=2.0,
        partly=4.0,
    ),
    Definition(
        "Robust to missing features",
        "sweeps",
        "rms error with a fifth of the features missing (of a single feature: of its pixels dead; "
        "sweep `missing`) over that with all, with 90 % found",
        unit="times",
        full=1.5,
        partly=3.0,
    ),
)

#: In the order of the survey's table.
DEFINITIONS: Mapping[str, Definition] = MappingProxyType({d.name: d for d in _ALL})
