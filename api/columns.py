"""The columns of every table that is given as CSV, and the text itself.

The command line and the HTTP service both take them from here, so that their files agree byte for
byte. A table has its columns whatever is asked: what a question does not touch is an empty cell.
This module imports nothing heavy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from api.cells import cell
from files.csv_writing import csv_text
from registry.taxonomy import taxonomy_rows

Row = Mapping[str, Any]

TAXONOMY = ("attribute", "value", "name", "category", "section", "section_name")
STUDIES = (
    *("key", "title", "authors", "year", "venue", "type", "doi", "url", "identity", "grade"),
    "state",
    *("task", "error", "accuracy", "detector", "mask", "model", "extractor"),
    *("accuracy_deg", "accuracy_kind", "precision_deg", "precision_kind", "fov_deg"),
    *("edition", "verified"),
)
STUDY = (
    *("attribute", "value", "basis", "source", "source_name", "note", "role"),
    *("name_in_study", "nearest"),
)
EDITIONS = ("name", "title", "studies", "version")
FLOWS = ("source", "target", "value", "studies")
FIGURES = ("figure", "title", "caption", "levels")
FIGURE_FLOWS = (
    *("level", "value", "name", "next_level", "next_value", "next_name"),
    *("count", "studies"),
)
FIGURE_MODELS = (
    *("level", "model_category", "calibration", "model", "name"),
    *("count", "memberships", "studies"),
)
FIGURE_PUBLICATIONS = ("part", "value", "stack", "count", "studies")
FIGURE_COORDINATES = (
    "study",
    "year",
    "detector",
    "mask",
    "fov_deg",
    "accuracy_rms_deg",
    "accuracy_deg",
    "accuracy_kind",
    "precision_deg",
    "precision_kind",
    "accuracy",
    "studies",
)
FIGURE_MATRIX = (
    *("row_level", "row", "row_name", "column_level", "column", "column_name"),
    *("state", "count", "studies", "reason", "unknown", "pipelines", "best_own_deg"),
    *("best_dataset", "best_extractor", "best_model", "command", "leads_to"),
)
RECOMMENDATIONS = (
    *("rank", "detector", "mask", "advised", "studies", "pareto", "calibration"),
    *("extractor", "compensations", "model", "calibration_studies", "support"),
    *("measured_dataset", "measured_extractor", "measured_model", "measured_error_deg"),
    *("measured_condition", "measured_conditions", "measured_field_deg", "measured_fov_deg"),
    *("measured_availability", "measured_latency_us", "measured_nominal_deg"),
    *("measured_nominal_condition", "measured_nominal_rms_deg", "measured_nominal_bound_deg"),
    *("measured_nominal_over_bound", "measured_nominal_repeatability_deg"),
    *("measured_nominal_availability", "measured_nominal_false_sun"),
    *("measured_own_deg", "measured_bench_deg", "measured_needs"),
    *("measured_units_count", "measured_units_least_deg", "measured_units_largest_deg"),
    *("measured_units_meeting", "measured_units_of"),
    *("measured_finer_dataset", "measured_finer_extractor", "measured_finer_model"),
    *("measured_finer_error_deg", "measured_finer_availability"),
)
ALGORITHMS = (
    *("name", "role", "taxonomy", "category", "observation", "kind", "accepts", "labels"),
    *("label_names", "studies", "origin", "version", "summary"),
)
DATASETS = (
    *("name", "version", "detector", "mask", "observation", "conditions", "units", "bounds"),
    *("description", "follows", "stands_for_idealisation", "stands_for_sensors"),
    *("splits_calibration_samples", "splits_test_samples", "splits_repeat_samples", "preview"),
)
DATASET = ("condition", "split", "samples", "data_hash", "bound_deg")
SAMPLE_ERRORS = (
    *("extractor", "model", "unit", "sample", "sun_x", "sun_y", "sun_z", "observable"),
    *("bound_deg", "error_deg", "doubt"),
)
REALISM = (
    *("dataset", "extractor", "model", "half_fov_deg", "rms_deg", "bound_deg"),
    *("repeatability_deg", "id", "name", "fov_full_deg", "accuracy_deg", "accuracy_kind"),
    *("accuracy_rms_deg", "precision_deg", "basis", "our_rms_deg", "accuracy_ratio"),
    *("precision_ratio", "explanation", "unexplained", "source"),
    "source_name",
)
_PLACE = ("dataset", "condition", "extractor", "model")
_WHAT = (
    *("dataset_version", "unit", "detector", "mask", "half_fov_deg", "extractor_taxonomy"),
    *("extractor_version", "model_taxonomy", "model_version"),
)
_SPREAD = (
    *("n_calibration", "n_test", "n_observable", "median_deg", "p95_deg", "p997_deg", "max_deg"),
    *("bias_alpha_deg", "bias_beta_deg", "rms_alpha_deg", "rms_beta_deg", "repeatability_deg"),
    *("over_bound", "over_bound_se", "over_bound_unit"),
)
_RINGS = (
    *("rms_0_10_deg", "rms_10_20_deg", "rms_20_30_deg", "rms_30_40_deg", "rms_40_50_deg"),
    *("rms_50_60_deg", "rms_60_70_deg", "rms_70_90_deg", "rms_90_180_deg"),
)
RESULTS = (
    *(*_PLACE, "status", "reason", "rms_deg", "charged_deg", "aligned_deg", "bound_deg"),
    *("bound_unit_deg", "availability", "false_sun", *_WHAT, *_SPREAD, *_RINGS, "metric_version"),
)
LEADERBOARD = (
    *("rank", "group", "tied", *_PLACE, "own_deg", "own_se", "on_bench_deg", "on_bench_basis"),
    *("rms_deg", "charged_deg", "aligned_deg", "bound_deg", "bound_unit_deg", "low_deg"),
    *("high_deg", "twin_of", "folded", "availability", "false_sun", "best_of_extractor", "studies"),
    *(*_WHAT, "status", "reason", *_SPREAD, *_RINGS, "metric_version", "unit_rms_deg"),
    *("latency_us", "time_ratio", "field_deg", "field_rms_deg", "widest_field_deg"),
)
ARCHITECTURES = (
    *("detector", "mask", "datasets", "dataset", "half_fov_deg", "extractor", "model", "studies"),
    *("own_deg", "own_se", "quoted_deg", "on_bench_deg", "on_bench_basis", "rms_deg", "bound_deg"),
    *("over_bound", "over_bound_se", "bound_unit_deg", "over_bound_unit", "availability"),
    *("unit_rms_deg", "others_low_deg", "others_high_deg", "runner_up_extractor"),
    *("runner_up_model", "runner_up_own_deg", "runner_up_unit_rms_deg", "first_group", "tie"),
    *("units_ahead", "units_compared", "finer_dataset"),
    *("finer_extractor", "finer_model", "finer_rms_deg", "finer_over_bound"),
    "finer_availability",
)
PARTS = (
    *("role", "part", "taxonomy", "boards", "answered", "within_1_5", "within_3", "within_10"),
    *("share_1_5", "share_3", "share_10", "median_over_bound", "leads", "reachable_10"),
)
SWEEPS = (
    *("series", "sweep", "point", "extractor", "rms", "bound", "over_bound", "status", "value"),
    *("n", "unit", "found_fraction", "kept_fraction", "wrong_fraction", "bias", "reason"),
    *("extractor_taxonomy", "extractor_version"),
)
CURVES = (
    *("dataset", "extractor", "model", "needed_poses", "needed_low", "needed_high"),
    *("error_poses", "answers_poses", "poses", "floor", "floor_error_deg", "over_bound"),
)
ASSESSMENT = (
    *("method", "property", "survey", "measured", "agreement", "value", "reason", "taxonomy"),
    *("case_study", "unit", "extractor", "measured_on"),
)
CLAIMS = (
    *("id", "section", "section_name", "study", "statement", "verdict", "trials", "explanation"),
)
CLAIM = (
    *("rule", "statistic", "decides", "standing", "estimate", "low", "high", "trials", "timed"),
    "second_standing",
)
SEARCH = ("rank", "kind", "id", "title", "excerpt", "score", "address")
COMPARISON = (
    *("detector", "mask", "dataset", "condition", "extractor", "model", "studies", "rms_deg"),
    *("over_least", "bound_deg", "over_bound", "over_bound_se", "own_deg", "on_bench_deg"),
    *("low_deg", "high_deg"),
    *("availability", "false_sun", "latency_us", "time_ratio", "needed_poses", "needed_low"),
    *("needed_high", "poses", "floor_error_deg", "half_fov_deg", "rank", "status", "reason"),
    *("finer_dataset", "finer_extractor", "finer_model", "finer_rms_deg", "finer_availability"),
)
ADVICE = (
    *("id", "requirement", "value", "detector", "mask", "model_category", "extractor"),
    *("section", "section_name", "note"),
)
PROTOCOL = ("about", "kind", "id", "text", "section", "section_name")


_LISTS = frozenset(
    (
        *("studies", "compensations", "calibration_studies", "measured_conditions", "accepts"),
        *("labels", "label_names", "conditions", "bounds", "follows", "stands_for_sensors"),
        "unit_rms_deg",
        *("datasets", "runner_up_unit_rms_deg"),
    )
)
_LISTS_OF_STUDIES = frozenset(STUDIES[STUDIES.index("task") :])


def sortable(columns: Sequence[str]) -> tuple[str, ...]:
    """Return the columns of a table whose cells hold one value each."""
    lists = _LISTS_OF_STUDIES if tuple(columns) == STUDIES else _LISTS
    return tuple(name for name in columns if name not in lists)


def flat(row: Row, columns: Sequence[str]) -> dict[str, Any]:
    """Return the values of a row by column, in the table's order; None for what it lacks."""
    found = dict(_values(row, frozenset(columns)))
    return {name: found.get(name) for name in columns}


def csv_of(columns: Sequence[str], rows: Iterable[Row]) -> str:
    """Return rows as CSV (RFC 4180, but lines end in a line feed alone, as files here do).

    Parameters
    ----------
    columns : of the table, in order; what rows have besides is left out
    rows : one mapping a row; a member of a nested mapping is the column `outer_inner`. Lists are
        joined by "; ", mappings that are a column themselves are JSON, nothing (None, NaN) is
        empty, and the taxonomy's "None" is spelled out (`registry.taxonomy.taxonomy_rows`)

    Returns
    -------
    str
        A header and a line a row.
    """
    made = (flat(row, columns).items() for row in rows)
    return csv_text(columns, ([cell(taxonomy_rows(*one)) for one in row] for row in made))


def _values(row: Row, wanted: frozenset[str], prefix: str = "") -> Iterator[tuple[str, Any]]:
    for name, value in row.items():
        column = prefix + name
        if column in wanted:
            yield column, value
        elif isinstance(value, Mapping):
            yield from _values(value, wanted, f"{column}_")
