"""What the docs say of the best pipelines: how near their bounds, and what holds them back."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from api.docs.markdown import table
from benchmark.leaderboard.headlines import headlines
from benchmark.leaderboard.holding import table as holding
from benchmark.leaderboard.holding.sentences import NEAR, PARTS, verdict
from benchmark.leaderboard.realism import realism
from benchmark.results.store import Store


def standings() -> str:
    """Set every data set's best pipeline beside its bound and the built sensors' accuracy."""
    built, scores = _built(), _leaders()
    rows = []
    for name, row in holding.rows().items():
        judged = verdict(row)
        held = "–" if judged.near else PARTS[judged.leading]
        rows.append(
            (
                f"[{name}](datasets.md#{name})",
                f"{row['extractor']} + {row['model']}",
                _number(row["rms_deg"]),
                _number(row["bound_deg"]),
                f"{row['rms_deg'] / row['bound_deg']:.3g}",
                _floor(scores.get(name)),
                _sensors(built.get(name)),
                held,
            )
        )
    header = ("data set", "best pipeline", "rms error (deg)", "bound (deg)", "ratio", "floor (deg)")
    return table((*header, "built sensors' accuracy (deg rms)", "held back by"), rows)


def contributions() -> str:
    """Write what each part of the chain contributes, a row a data set."""
    rows = []
    for name, row in holding.rows().items():
        parts = verdict(row).parts_deg
        cells = (_number(parts[part]) if part in parts else "–" for part in PARTS)
        rows.append((name, _number(row["as_is_deg"]), *cells))
    return table(("data set", "as it is", *(part.replace("_", " ") for part in PARTS)), rows)


def sentences() -> str:
    """Say of every data set what was measured, and of the built sensors what is different."""
    built, lines = _built(), []
    for name, row in holding.rows().items():
        said = verdict(row).sentence
        explained = (built.get(name) or {}).get("sentence")
        lines.append(f"- {said}" + (f" Beside built sensors: {explained}" if explained else ""))
    near = sum(verdict(row).near for row in holding.rows().values())
    counted = f"{near} of {len(lines)} best pipelines are within {NEAR:g} of their bounds."
    return counted + "\n\n" + "\n".join(lines)


def headline_table() -> str:
    """Set the numbers that mapped studies are known for beside the same methods here."""
    rows, said = [], []
    for row in headlines(Store().rows(), _conditions()):
        stands = f"{row['extractor']} + {row['model']}" if row["dataset"] else "nothing"
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
                _angle(row["floor_deg"]),
                "–" if row["availability"] is None else f"{100 * row['availability']:.0f} %",
            )
        )
        said.append(f"- {row['study']}, {row['kind']}: {row['difference']}")
    header = ("study", "its number is", "published", "data set", "stands for it", "ours", "ratio")
    return table((*header, "floor", "answered"), rows) + "\n\n" + "\n".join(said)


def _angle(degrees: float | None) -> str:
    """Spell an angle in degrees; in arcseconds below a five-hundredth of one."""
    if degrees is None:
        return "–"
    return f"{degrees:.2g} deg" if degrees >= 1 / 500 else f"{degrees * 3600:.2g} arcsec"


@cache
def _leaders() -> Mapping[str, Mapping[str, Any]]:
    return holding.leaders(Store().rows(), _conditions())


@cache
def _built() -> Mapping[str, Mapping[str, Any]]:
    return {row["dataset"]: row for row in realism(Store().rows(), _conditions())}


def _conditions() -> Mapping[str, str]:
    return {name: row["condition"] for name, row in holding.rows().items()}


def _floor(score: Mapping[str, Any] | None) -> str:
    floor = None if score is None else score["floor_deg"]
    return "–" if floor is None else _number(floor)


def _sensors(beside: Mapping[str, Any] | None) -> str:
    sensors = (beside or {}).get("sensors", ())
    known = [sensor for sensor in sensors if sensor["accuracy_rms_deg"] is not None]
    said = [f"{sensor['accuracy_rms_deg']:.2g} ({sensor['name']})" for sensor in known]
    return "; ".join(said) or "none published"


def _number(value: float) -> str:
    return f"{value:.2g}" if value >= 1e-6 else "0"
