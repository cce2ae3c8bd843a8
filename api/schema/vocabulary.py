"""What members of answers and columns of tables mean, where several models have them.

A model says itself what only it has, or what means something else in it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

MEANINGS: Mapping[str, str] = {
    "accuracy_kind": "Statistic of the published accuracy, such as 3sigma or rms.",
    "architectures": "Architectures (detector and mask), best first.",
    "attribute": "Attribute of the taxonomy, such as detector or mask.",
    "attributes": "Values by attribute of the taxonomy.",
    "authors": "Authors, separated by semicolons.",
    "availability": "Availability: share of observable test samples with an answer.",
    "basis": "Basis of the value: where it was read, or how inferred.",
    "bound_deg": "RMS Cramer-Rao bound for a known sensor unit, degrees.",
    "bound_unit_deg": (
        "RMS Cramer-Rao bound for a unit known only through its calibration, degrees."
    ),
    "caption": "Caption of the figure in the survey.",
    "category": "Category of that value.",
    "claim": "Identifier of the claim.",
    "compensations": "Compensations between extractor and model, in the order they run.",
    "condition": "Named condition of the data set.",
    "conditions": "Named conditions, separated by semicolons.",
    "constraint": "Requirement, or requirements joined by +.",
    "count": "Number of items.",
    "data_hash": "Hash of the samples.",
    "dataset": "Name of the standard data set.",
    "datasets": "Data sets, by name.",
    "description": "Description.",
    "detail": "Explanation, one sentence.",
    "detector": "Detector, as in the survey's taxonomy.",
    "doi": "Digital object identifier, without resolver.",
    "edition": "survey: mapped by the survey; extension: a study it does not map.",
    "extractor": "Name of the feature extractor's implementation.",
    "extractor_taxonomy": "Extractor, as in the survey's taxonomy.",
    "extractor_version": "Version of the extractor.",
    "figure": "Name of the figure.",
    "grade": "Grade of the implementation: faithful, assumed, close, stand-in or none.",
    "half_fov_deg": "Half field of view of the sensor, degrees.",
    "id": "Identifier.",
    "items": "Items of this page.",
    "key": "Key of the study, as in the survey's bibliography.",
    "kind": "Kind of features.",
    "left_out": "Studies not shown because a value is unknown.",
    "level": "Attribute that the value belongs to.",
    "links": "Links between values, with the studies that have both.",
    "mask": "Mask, as in the survey's taxonomy.",
    "method": "Name of the method in the survey.",
    "model": "Name of the calibration model's implementation.",
    "model_taxonomy": "Model, as in the survey's taxonomy.",
    "name": "Unique name.",
    "nodes": "Values of the chart with their studies.",
    "note": "Remark; empty where there is none.",
    "over_bound": "RMS of one sensor unit divided by the bound of the same samples.",
    "pipelines": "Number or list of pipelines.",
    "precision_deg": "Published precision, degrees.",
    "properties": "Outcome for each property.",
    "property": "Property in the survey's assessment, such as robust to noise.",
    "rank": "Position in the list; 1 is the best.",
    "reason": "Reason for a missing score; empty otherwise.",
    "repeatability_deg": (
        "Repeatability: standard deviation of answers at a fixed pose, over both axes, degrees."
    ),
    "rms_deg": "RMS separation angle of one unit, observable samples with an answer, degrees.",
    "role": "extractor or model.",
    "rows": "Rows of the table.",
    "rule": "Name of the criterion within its claim.",
    "samples": "Samples in the file.",
    "scores": "Number or list of scores.",
    "sensors": "Built sensors with published figures.",
    "source": "Source.",
    "split": "calibration, test or repeat.",
    "state": "complete: every value is implemented; partial: some; none.",
    "status": "ok, refused (the model cannot work on these data) or failed, with a reason.",
    "studies": "Studies it is based on, separated by semicolons.",
    "study": "Key of the study.",
    "survey": "Score of the survey.",
    "task": "Task, as in the survey's taxonomy.",
    "taxonomy": "Value of the survey's taxonomy that is implemented.",
    "text": "Text.",
    "title": "Title; empty if the study is not identified.",
    "type": "Kind of publication or of problem.",
    "unit": "Unit of the sensor, or unit of the value.",
    "units": "Number of sensor units measured; null if none.",
    "value": "The value.",
    "venue": "Journal, conference or publisher.",
    "version": "Version; raised when results change intentionally.",
    "words": "Description in words.",
    "year": "Year of publication.",
}

#: An error in a ring of the field (`benchmark.metrics.rings.Ring.column`).
_RING = re.compile(r"rms_(\d+)_(\d+)_deg")
#: Ends at a semicolon or full stop, not at the point of a number.
_CLAUSE = re.compile(r"^(.+?)(; |\. |\.$)")
#: By the end of a name.
_UNITS: Mapping[str, str] = {"deg": "degrees", "us": "microseconds"}


def meaning(name: str, said: str | None = None) -> str:
    """Return what a member means, with the unit that its name ends in.

    `said`: what its model says; by default what the vocabulary says, or
    nothing.
    """
    if ring := _RING.fullmatch(name):
        return f"RMS error {ring[1]} to {ring[2]} degrees off the axis."
    text = said or MEANINGS.get(name, "")
    unit = _UNITS.get(name.rpartition("_")[2])
    if unit and unit not in text:
        return add_to_first_clause(text, f" ({unit})")
    return text


def add_to_first_clause(text: str, words: str) -> str:
    """Return a text with words behind its first clause; what is empty stays empty."""
    return _CLAUSE.sub(lambda found: f"{found[1]}{words}{found[2]}", text, count=1)
