"""Measured pipelines made up for a test."""

from registry.measured_pipelines import MeasuredPipeline, Score

_SCORE = {"rms_deg", "bound_deg", "over_bound", "repeatability_deg", "availability", "is_available"}

STUDY = {
    "task": ["Cost"],
    "detector": ["CMOS"],
    "mask": ["Slit"],
    "model": ["SPM"],
    "extractor": ["BCTM"],
}


def pipeline(**changed: object) -> MeasuredPipeline:
    """A pipeline on CMOS behind a slit that errs 0.1 deg over 120, with some of it changed."""
    nominal: dict[str, object] = {"condition": "nominal", "rms_deg": 0.1, "availability": 1.0}
    row: dict[str, object] = {
        "dataset": "d",
        "detector": "CMOS",
        "mask": "Slit",
        "extractor": "bctm",
        "extractor_taxonomy": "BCTM",
        "model": "spm",
        "stages": ("SPM",),
        "half_fov_deg": 60.0,
    }
    for name, value in changed.items():
        (nominal if name in {*_SCORE, "cones"} else row)[name] = value
    return MeasuredPipeline(nominal=Score(**nominal), **row)  # type: ignore[arg-type]
