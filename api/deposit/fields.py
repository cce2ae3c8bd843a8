"""What the columns of the bundle's measured tables hold: type, unit and meaning.

The survey's tables bring their own descriptor; here stand the tables that come from the benchmark.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from benchmark.metrics.rings import RINGS

Type = Literal["string", "integer", "number", "boolean"]

TABLE_SCHEMA = "https://datapackage.org/profiles/2.0/tableschema.json"

_FIELDS: dict[str, tuple[Type, str]] = {
    # what follows from the facts
    "study": ("string", "Key of the study."),
    "edition": ("string", "survey: mapped by the survey; extension: added after it."),
    "edition_title": ("string", "Name of the edition."),
    "edition_studies": ("integer", "Number of its studies."),
    "edition_version": (
        "string",
        "Version of the data package, number of studies, first digits of the tables' SHA-256.",
    ),
    "title": ("string", "Title; empty where the study is not identified."),
    "authors": ("string", "Authors, separated by semicolons."),
    "year": ("integer", "Year of publication."),
    "venue": ("string", "Where it was published."),
    "type": ("string", "Kind of publication."),
    "doi": ("string", "Digital object identifier, without resolver."),
    "grade": (
        "string",
        "How near what runs is to the study: faithful, close, stand-in, none.",
    ),
    "state": ("string", "Whether values of the study are left out: complete, partial or none."),
    "detector_basis": (
        "string",
        "What the detector rests on: stated, inferred, implied, recalled, defaulted.",
    ),
    "mask_basis": ("string", "What the mask rests on."),
    "extractor_basis": ("string", "What the extractor rests on."),
    "model_basis": ("string", "What the model rests on."),
    "assumed": ("string", "Of each part that is not stated, the reason or rule why it is there."),
    "finding": ("string", "Identifier of the finding."),
    "clause": ("integer", "Number of the clause within the finding."),
    "finding_verdict": ("string", "Of all its clauses: partly where some are reproduced."),
    "verdict": ("string", "reproduced, tied, contradicted or undecidable."),
    "matching": ("integer", "Studies that pass the clause's filter."),
    "counted": ("integer", "Those of them with a known value of what it ranks."),
    "named": ("string", "Studies of each value that the clause names."),
    "ranking": ("string", "Studies of every value, most first."),
    "settled_by": ("string", "The counts that decide it, and the evidence that would turn it."),
    "per": ("string", "year or venue."),
    "year_or_venue": ("string", "The year, or the venue in one spelling."),
    "studies_count": ("integer", "Number of mapped studies."),
    # the survey's claims, tried
    "claim": ("string", "Identifier of the claim."),
    "claim_verdict": (
        "string",
        "reproduced, partly, refuted or not testable here, by the standings of its rules.",
    ),
    "measured_on": ("string", "Data, sensors and methods of the trials."),
    "replicate": ("string", "What differs between trials: unit of the sensor, or seed."),
    "second_method": ("string", "The other method that the outcome was checked by."),
    "second_agrees": ("boolean", "Whether that method says the same of every rule."),
    "explanation": ("string", "Why a claim did not, or not wholly, come out."),
    "rule": ("string", "Name of the rule within its claim."),
    "statistic": ("string", "What is computed in every trial."),
    "decides": ("string", "What the statistic has to be for the rule to hold."),
    "standing": (
        "string",
        "holds or fails: the whole interval is on one side of the limit; open: it is not.",
    ),
    "estimate": ("number", "Mean of the statistic over the trials, of ratios the geometric one."),
    "low": ("number", "Lower end of the mean's 95 % interval."),
    "high": ("number", "Upper end of the mean's 95 % interval."),
    "trials_count": ("integer", "Trials that gave a number."),
    "timed": ("boolean", "Whether it is a ratio of run times, which differs from run to run."),
    "trial": ("integer", "Number of the trial: the unit of the sensor, or the seed."),
    "statistic_value": ("number", "The statistic in this trial."),
    "second_value": ("number", "The same by the second method."),
    # what was measured
    "rank": (
        "integer",
        "Place in the data set's condition, best first; those that answer less than 95 % last.",
    ),
    "group": (
        "integer",
        "1 for what a paired test over units does not tell apart from the leader, 2 for the next.",
    ),
    "tied": ("boolean", "Whether others share the rank."),
    "own_deg": ("number", "Own error: geometric mean over units of charged_deg, degrees."),
    "own_se": ("number", "Relative standard error of own_deg over units."),
    "on_bench_deg": ("number", "Error expected when calibrated on the standard bench, degrees."),
    "on_bench_basis": ("string", "measured on drawn benches, or estimated."),
    "twin_of": ("string", "A pipeline of the same extractor with the same numbers throughout."),
    "folded": ("boolean", "Whether it is far behind the leader."),
    "unit": ("integer", "Unit of the sensor; 0 is the standard one."),
    "dataset": ("string", "Name of the standard data set."),
    "dataset_version": ("integer", "Version of the data set."),
    "condition": ("string", "Named condition of the data set."),
    "detector": ("string", "Detector, as in the survey's taxonomy."),
    "mask": ("string", "Mask, as in the survey's taxonomy."),
    "half_fov_deg": ("number", "Half field of view of the sensor, degrees."),
    "extractor": ("string", "Name of the feature extractor's implementation."),
    "extractor_taxonomy": ("string", "Extractor, as in the survey's taxonomy."),
    "extractor_version": ("integer", "Version of the extractor's numbers."),
    "model": ("string", "Name of the calibration model's implementation."),
    "model_taxonomy": ("string", "Model, as in the survey's taxonomy."),
    "model_version": ("integer", "Version of the model's numbers."),
    "status": (
        "string",
        "ok, refused (the model cannot work on these data) or failed, with a reason.",
    ),
    "reason": ("string", "Why there is no score; empty where there is one."),
    "n_calibration": ("integer", "Samples of the calibration split."),
    "n_test": ("integer", "Samples of the test split."),
    "n_observable": ("integer", "Test samples whose direction is observable."),
    # accuracy
    "availability": ("number", "Answered share of the observable test samples."),
    "false_sun": ("number", "Answered share of the test samples that are not observable."),
    "rms_deg": (
        "number",
        "Root mean square separation angle of observable samples with an answer, degrees.",
    ),
    "charged_deg": (
        "number",
        "Root mean square separation angle of all answers, observable sample or not, degrees.",
    ),
    "aligned_deg": ("number", "Root mean square angle left after the best rotation, degrees."),
    "median_deg": ("number", "Median separation angle, degrees."),
    "p95_deg": ("number", "95th percentile of the separation angle, degrees."),
    "p997_deg": ("number", "99.7th percentile of the separation angle, degrees."),
    "max_deg": ("number", "Largest separation angle, degrees."),
    "bias_alpha_deg": ("number", "Mean error of alpha, degrees."),
    "bias_beta_deg": ("number", "Mean error of beta, degrees."),
    "rms_alpha_deg": ("number", "Root mean square error of alpha, degrees."),
    "rms_beta_deg": ("number", "Root mean square error of beta, degrees."),
    "repeatability_deg": (
        "number",
        "Standard deviation of answers to a pose held still, over both axes, degrees.",
    ),
    "bound_deg": ("number", "Root mean square of the Cramer-Rao bound, unit known, degrees."),
    "over_bound": ("number", "Root mean square error divided by the bound."),
    "over_bound_se": ("number", "Standard error of over_bound."),
    "bound_unit_deg": (
        "number",
        "Root mean square of the Cramer-Rao bound, unit unknown but for flats and darks, degrees.",
    ),
    "over_bound_unit": ("number", "Root mean square error divided by bound_unit_deg."),
    **{
        ring.column: (
            "number",
            f"Root mean square error {ring.inner_deg} to {ring.outer_deg} degrees off the axis.",
        )
        for ring in RINGS
    },
    "low_deg": ("number", "Smallest error of a unit (charged_deg), degrees."),
    "high_deg": ("number", "Largest error of a unit, degrees."),
    "unit_rms_deg": ("string", "Error of each unit (charged_deg), separated by semicolons."),
    # sweeps
    "series": ("string", "Reference feature; none where no feature fits the extractor."),
    "sweep": ("string", "What is varied; none where the feature is not measured."),
    "point": ("string", "Point of the sweep; none where the feature is not measured."),
    "value": ("number", "Place of the point on the sweep's axis; empty where it is a word."),
    "n": ("integer", "Samples at the point; 0 where the extractor's design refuses it."),
    "measured_in": ("string", "Unit of rms, bias and bound."),
    "kept_fraction": ("number", "Share of samples found within 3 px of the truth."),
    "wrong_fraction": (
        "number",
        "Share of samples answered more than 1 px from the truth, or where there is none.",
    ),
    "rms": ("number", "Root mean square error of one coordinate of the found samples."),
    "bias": ("number", "Root mean square over the coordinates of the mean error."),
    "bound": ("number", "Root mean square Cramer-Rao bound of one coordinate."),
    "found_fraction": ("number", "Share of samples with a feature found."),
    # learning curves
    "place": ("integer", "Place among the leaders of its data set, each with another model."),
    "poses": ("integer", "Calibration poses; of a whole curve all that the data set gives."),
    "in_order": ("boolean", "Whether the poses are a time series, taken in its order."),
    "floor": (
        "string",
        "fitted: where a law fitted to the curve ends; all: the error with all poses; none.",
    ),
    "bench_aligned_deg": (
        "number",
        "What the best rotation leaves of bench_deg, root mean square over drawn benches, degrees.",
    ),
    "boresight_deg": ("number", "Control: error of always answering boresight, degrees."),
    "oracle_deg": ("number", "Control: error of the truth with the bound's noise, degrees."),
    "bench_deg": (
        "number",
        "Fixed error of the standard bench's directions over the field, degrees.",
    ),
    "floor_error_deg": ("number", "The floor, root mean square over the units, degrees."),
    "floor_low_deg": ("number", "Where nine in ten fitted floors lie, from, degrees."),
    "floor_high_deg": ("number", "Where nine in ten fitted floors lie, to, degrees."),
    "exponent": ("number", "b of the fitted law f^2 + a poses^-b of the squared error."),
    "misfit": ("number", "By how much the law misses the errors, relative, root mean square."),
    "all_deg": ("string", "Error with all poses by unit, separated by semicolons."),
    "needed": ("string", "Poses needed by draw, separated by semicolons; empty: more than all."),
    "error_from": ("string", "The same by error alone."),
    "answers_from": ("string", "The same by answers alone."),
    "refusal": ("string", "Why the first refused draw was."),
    "draws": ("integer", "Draws of poses, over all units."),
    "reached": ("integer", "Draws that come within 10 % of the floor."),
    "needed_poses": (
        "integer",
        "Poses from which on half of the draws err by at most 1.1 floors and answer 95 %.",
    ),
    "needed_low": ("integer", "The same of the first draw."),
    "needed_high": ("integer", "The same of the last draw; empty where all poses are too few."),
    "error_poses": ("integer", "The same of half of the draws, by error alone."),
    "answers_poses": ("integer", "The same of half of the draws, by answers alone."),
    "middle_deg": ("number", "Median over draws of the root mean square error, degrees."),
    "least_deg": ("number", "Smallest of them, degrees."),
    "largest_deg": ("number", "Largest of them, degrees."),
    "refused": ("integer", "Draws whose poses the model refused."),
    # provenance
    "split": ("string", "calibration, test or repeat."),
    "observable": ("integer", "Samples of the test split whose direction is observable."),
    "head_bound_deg": ("number", "Bound of the first samples, degrees."),
    "data_hash": ("string", "Hash of the samples."),
    "file": ("string", "Path in this bundle."),
    "samples": ("integer", "Samples in the file."),
    "samples_of": ("integer", "Samples of the whole split."),
    "head_hash": ("string", "Hash of the first samples."),
    "metric_version": ("integer", "Version of how errors become numbers."),
    # algorithms and data sets
    "name": ("string", "Unique name."),
    "role": ("string", "extractor or model."),
    "taxonomy": ("string", "Value of the survey's taxonomy that is implemented."),
    "category": ("string", "Category of that value."),
    "observation": ("string", "What is read: frames, profiles, currents or events."),
    "kind": ("string", "What an extractor's features mean."),
    "accepts": ("string", "Kinds of features a model reads, separated by semicolons."),
    "labels": ("string", "The survey's labels of what is implemented, separated by semicolons."),
    "label_names": ("string", "What these labels name, in the same order."),
    "studies": ("string", "Studies that are followed, separated by semicolons."),
    "origin": ("string", "survey: described there; ours: not."),
    "version": ("integer", "Raised when the numbers change on purpose."),
    "summary": ("string", "What it does."),
    "conditions": ("string", "Named conditions, separated by semicolons."),
    "description": ("string", "What it is."),
    "follows": ("string", "Studies whose sensor it follows, separated by semicolons."),
}


def described(column: str) -> tuple[Type, str]:
    """Return type and meaning of a column; KeyError for one that nothing is known of."""
    return _FIELDS[column]


def schema(
    columns: Sequence[str],
    where: str,
    *,
    primary: Sequence[str],
    foreign: Mapping[str, tuple[str, str]] | None = None,
) -> dict[str, Any]:
    """Describe a table as Table Schema v2.

    Parameters
    ----------
    columns : of the table, in order
    where : the table's name, for messages
    primary : columns that identify a row
    foreign : column -> (resource, column) that its values stand in

    Raises
    ------
    ValueError
        For a column nothing is known of: a table does not go out half described.
    """
    unknown = [name for name in columns if name not in _FIELDS]
    if unknown:
        raise ValueError(
            f"{where}: no description of column {', '.join(unknown)} in api.deposit.fields"
        )
    required = {*primary, *(foreign or {})}
    fields = []
    for name in columns:
        kind, description = _FIELDS[name]
        field: dict[str, Any] = {"name": name, "type": kind, "description": description}
        if name in required:
            field["constraints"] = {"required": True}
        fields.append(field)
    described: dict[str, Any] = {
        "$schema": TABLE_SCHEMA,
        "fields": fields,
        "missingValues": [""],
        "primaryKey": list(primary),
    }
    if foreign:
        described["foreignKeys"] = [
            {"fields": [column], "reference": {"resource": resource, "fields": [target]}}
            for column, (resource, target) in foreign.items()
        ]
    return described
