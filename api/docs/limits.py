"""Generated parts of docs/limits.md: errors and main error sources of the best pipelines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

from api.docs.knowledge import knowledge
from api.docs.markdown import table
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, PARTS, bound_of, verdict
from benchmark.leaderboard.findings.methods import is_drawn
from benchmark.leaderboard.headlines import Headline, accuracies, headlines, rank_correlation
from benchmark.leaderboard.realism import realism
from benchmark.leaderboard.summaries import digits
from benchmark.results.store import Store
from survey_data.hardware import hardware

#: Factor within which a published and a measured accuracy agree.
_NEAR = 3
#: Ratio from which on no digit stands behind the point.
_WHOLE = 99.5


def best_pipelines() -> str:
    """Set every data set's best pipeline beside its bound and the built sensors' accuracy."""
    built, pins, own = _build(), Store().pins(), knowledge().measurements.nominal
    rows = []
    for name, row in ERROR_BUDGET.read().items():
        judged, bound = verdict(row), bound_of(row)
        pin = pins.get((name, row["condition"], "test"))
        rows.append(
            (
                f"[{name}](datasets.md#{name})",
                f"{row['extractor']} + {row['model']}",
                digits(own[name, row["extractor"], row["model"]]["own_deg"]),
                digits(row["rms_deg"]),
                digits(bound),
                digits(row["rms_deg"] / bound),
                "–" if judged.is_near_bound else PARTS[judged.leading_part],
                digits(pin.bench_deg if pin else None, nothing="–"),
                _sensors(name, built.get(name)),
            )
        )
    header = (
        "data set",
        "best pipeline",
        "own error (deg)",
        "unit 0 RMS (deg)",
        "bound (deg)",
        "unit 0 / bound",
        "main error source",
    )
    return table((*header, "bench adds (deg)", "built sensors, reported (deg RMS)"), rows)


def sentences() -> str:
    """Count the best pipelines near their bounds; name the main error source of each other."""
    judged = [verdict(row) for row in ERROR_BUDGET.read().values()]
    far = [one for one in judged if not one.is_near_bound]
    counted = (
        f"{len(judged) - len(far)} of {len(judged)} best pipelines are within {NEAR:g} times "
        "their bounds. The others:"
    )
    return counted + "\n\n" + "\n".join(f"- {one.sentence}" for one in far)


def headline_table() -> str:
    """Set every accuracy and precision that a study publishes beside ours, the worst first."""
    known = knowledge()
    every = headlines(known.measurements.score_of, known.facts.studies.values(), known.resolutions)
    rows = [_headline(one) for one in every]
    header = ("study", "quantity", "published", "ours, unit 0", "ratio", "bench adds", "data set")
    said = [
        f"- {one.study}, {one.published.quantity}: {' '.join(reasons)}"
        for one in every
        if (reasons := _reasons(one))
    ]
    parts = (_summary(every), table((*header, "condition", "pipeline", "answered"), rows))
    return "\n\n".join((*parts, "\n".join(said)))


def _summary(every: Sequence[Headline]) -> str:
    """Count the accuracies near the published ones, with range and rank correlation."""
    ratios = [one.ratio for one in accuracies(every) if one.ratio is not None]
    near = sum(1 / _NEAR <= ratio <= _NEAR for ratio in ratios)
    correlation, count = rank_correlation(every)
    return (
        f"Accuracies of {count} studies: {near} of ours are within {_NEAR} times the published "
        f"one; ratios are {min(ratios):.2g} to {max(ratios):.0f}. Spearman's rank correlation of "
        f"published and our accuracies is {correlation:.2f}."
    )


def _headline(one: Headline) -> tuple[str, ...]:
    published = f"{one.published.quantity}, {one.published.statistic.name}"
    if one.place is None or one.our_deg is None or one.ratio is None:
        return (one.study, published, _angle(one.published.value_deg), "not measured", *["–"] * 6)
    dataset, condition, extractor, model = one.place
    pin = knowledge().measurements.pins.get((dataset, condition, "test"))
    bench = None if pin is None or one.published.quantity == "precision" else pin.bench_deg
    return (
        one.study,
        published,
        _angle(one.published.value_deg),
        f"{_angle(one.our_deg)} ({one.our_statistic})",
        f"{one.ratio:.2g}" if one.ratio < _WHOLE else f"{one.ratio:.0f}",
        _angle(bench),
        f"[{dataset}](datasets.md#{dataset})",
        condition,
        f"{extractor} + {model}",
        "–" if one.availability is None else f"{100 * one.availability:.0f} %",
    )


def _reasons(one: Headline) -> list[str]:
    """Say why the two numbers differ, as far as it is known."""
    drawn = one.published.quantity == "accuracy" and one.place and is_drawn(one.place[-1])
    return [
        *(["Ours has the constants of the drawing, nothing is fitted."] if drawn else []),
        *([one.difference] if one.difference else []),
    ]


def _angle(degrees: float | None) -> str:
    """Spell an angle in degrees; in arcseconds below a five-hundredth of one."""
    if degrees is None:
        return "–"
    return f"{degrees:.2g} deg" if degrees >= 1 / 500 else f"{degrees * 3600:.2g} arcsec"


@cache
def _build() -> Mapping[str, Mapping[str, Any]]:
    return {row["dataset"]: row for row in realism(Store().rows(), _conditions())}


def _conditions() -> Mapping[str, str]:
    return {name: row["condition"] for name, row in ERROR_BUDGET.read().items()}


def _sensors(dataset: str, beside: Mapping[str, Any] | None) -> str:
    """List built sensors with their accuracies; a detector that is not the data set's is named."""
    detector = knowledge().measurements.presets[dataset].detector
    sensors = (beside or {}).get("sensors", ())
    known = [sensor for sensor in sensors if sensor["accuracy_rms_deg"] is not None]
    said = []
    for sensor in known:
        built = hardware()[sensor["id"]].detector
        other = f", {built}" if built and built != detector else ""
        said.append(f"{digits(sensor['accuracy_rms_deg'])} ({sensor['name']}{other})")
    return "; ".join(said) or "none published"
