"""Generated parts of docs/limits.md: errors and main error sources of the best pipelines."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.docs.knowledge import knowledge
from api.docs.markdown import table
from benchmark.error_budget.record import RECORD as ERROR_BUDGET
from benchmark.error_budget.sentences import NEAR, PARTS, bound_of, verdict
from benchmark.leaderboard.headlines import headlines
from benchmark.leaderboard.realism import realism
from benchmark.leaderboard.summaries import digits
from benchmark.results.store import Store


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
                _sensors(built.get(name)),
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
    """Set the numbers that mapped studies are known for beside the same methods here."""
    rows, said, pins = [], [], Store().pins()
    for row in headlines(Store().rows(), _conditions()):
        stands = f"{row['extractor']} + {row['model']}" if row["dataset"] else "nothing"
        pin = pins.get((row["dataset"], _conditions().get(row["dataset"], ""), "test"))
        bench = None if pin is None or row["kind"] == "precision" else pin.bench_deg
        rows.append(
            (
                row["study"],
                f"{row['kind']}, {row['statistic']}",
                _angle(row["published_deg"]),
                f"[{row['dataset']}](datasets.md#{row['dataset']})" if row["dataset"] else "–",
                stands,
                "not measured"
                if row["our_deg"] is None
                else f"{_angle(row['our_deg'])} ({row['our_statistic']})",
                "–" if row["ratio"] is None else f"{row['ratio']:.2g}",
                _angle(bench),
                "–" if row["availability"] is None else f"{100 * row['availability']:.0f} %",
            )
        )
        said.append(f"- {row['study']}, {row['kind']}: {row['difference']}")
    header = ("study", "quantity", "reported", "data set", "pipeline", "ours, unit 0", "ratio")
    return table((*header, "bench adds", "answered"), rows) + "\n\n" + "\n".join(said)


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


def _sensors(beside: Mapping[str, Any] | None) -> str:
    sensors = (beside or {}).get("sensors", ())
    known = [sensor for sensor in sensors if sensor["accuracy_rms_deg"] is not None]
    said = [f"{digits(sensor['accuracy_rms_deg'])} ({sensor['name']})" for sensor in known]
    return "; ".join(said) or "none published"
