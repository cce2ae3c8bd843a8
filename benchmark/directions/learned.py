"""Whether a network beats the best extractor and model: by the rule of its direction."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Any

from benchmark.directions.duels import Duel, judge, verdict
from benchmark.directions.trials import Trial, not_tried
from benchmark.learned.sparse_measure import PAPER_DEG
from benchmark.learned_faults.curves import NONE_DEG, curve, logs

Row = Mapping[str, Any]

#: The way of reading that decides, and what it meets.
_FIRST, _SECOND = "seed 0", "classical"


def learned(rows: Sequence[Row]) -> Trial:
    """Decide by the rows of the experiment."""
    heat = [row for row in rows if row["network"] == "heat map"]
    if not heat:
        return not_tried(rows)
    found = [_met(row) for row in heat]
    wins, losses = (sum(one.outcome == name for one in found) for name in ("win", "loss"))
    ratios = sorted(one.ratio for one in found)
    over = [_over_bound(row, _FIRST) for row in heat]
    text = (
        f"Of {len(found)} data sets the network errs less on {wins}, the best pipeline on "
        f"{losses}; the ratio of errors is {ratios[0]:.2g} to {ratios[-1]:.2g}. The network's "
        f"error is {min(over):.2g} to {max(over):.2g} times the bound."
    )
    text += "".join(map(_seeds, heat)) + _trusted(heat)
    text += "".join(_sparse(row) for row in rows if row["network"] == "sscnn")
    text += under_faults([row for row in rows if row["network"] == "sscnn under faults"])
    middle, unit = float(f"{median(ratios):.4g}"), "error, network over pipeline"
    return Trial(verdict(found), text, middle, 1.0, unit, (), found)


def _errors(row: Row, way: str) -> list[float]:
    return [NONE_DEG if error is None else error for error in row["errors_deg"][way]]


def _met(row: Row) -> Duel:
    pairs = zip(_errors(row, _FIRST), _errors(row, _SECOND), strict=True)
    names = ("heat map", row["model"]), (row["extractor"], row["model"])
    return judge(row["dataset"], *names, [math.log(one / other) for one, other in pairs])


def _over_bound(row: Row, way: str) -> float:
    logs = [math.log(error / row["bound_deg"]) for error in _errors(row, way)]
    return math.exp(sum(logs) / len(logs))


def _seeds(row: Row) -> str:
    """Say how far training seeds are apart, where there are several."""
    over = [_over_bound(row, way) for way in row["errors_deg"] if way.startswith("seed")]
    if len(over) < 2:
        return ""
    return (
        f" On {row['dataset']} {len(over)} training seeds give {min(over):.2g} to "
        f"{max(over):.2g} times the bound."
    )


def _trusted(rows: Sequence[Row]) -> str:
    """Say how often networks and pipelines answer wrongly without a flag."""
    said = []
    for trial, name in (
        ("no Sun", "without a Sun"),
        ("two Suns", "with two"),
        ("unseen mask",) * 2,
    ):
        shares = []
        for way in (_FIRST, _SECOND):
            of = [one for row in rows for one in row["trust"]]
            counts = [one for one in of if (one["way"], one["trial"]) == (way, trial)]
            frames = sum(one["frames"] for one in counts)
            shares.append(100.0 * sum(one["wrong"] for one in counts) / max(frames, 1))
        said.append(f"{name} {shares[0]:.2g} % ({shares[1]:.2g} %)")
    return f" Wrong answers without a flag, in brackets the pipelines': {', '.join(said)}."


def _sparse(row: Row) -> str:
    """Say what came of the network straight to two angles, and why."""
    means = {one["learned"]: one["mean_deg"] for one in row["ablation"]}
    names = ("other units, alone", "other units, tuned", "no network")
    alone, tuned, best = (means[name] for name in names)
    own = [
        f"{one['mean_deg']:.2g} deg ({one['frames']} frames, {one['steps']} steps)"
        for one in row["ablation"]
        if "itself" in one["learned"]
    ]
    return (
        " SSCNN, sparse and straight to two angles (Herman2025c states a mean of "
        f"{PAPER_DEG:g} deg), is off by {alone:.2g} deg on {row['dataset']}, by {tuned:.2g} deg "
        f"once calibrated on the unit, the best pipeline by {best:.2g} deg; trained on frames of "
        "the scored unit itself, "
        f"by {', '.join(own)}."
    )


def under_faults(rows: Sequence[Row]) -> str:
    """Say who errs less under which fault, and how often both are far off; "" for no rows."""
    if not rows:
        return ""
    cases = [(row, at) for row in rows for at in range(1, len(row["strengths"]))]
    names = ("sscnn", "homography"), (rows[0]["extractor"], rows[0]["model"])
    met = [judge(row["fault"], *names, logs(row, at)).outcome for row, at in cases]
    wins, losses = met.count("win"), met.count("loss")
    seldom = sum(
        one == "win" and _size(row, "classical", at) < _size(row, "network", at)
        for one, (row, at) in zip(met, cases, strict=True)
    )
    clean = [_size(rows[0], way, 0) for way in ("network", "classical")]
    strongest = []
    for row in rows:
        shares = [
            f"{100.0 * (curve(row, way, member)[-1] or 0.0):.0f} %"
            for member in ("far", "answered")
            for way in ("network", "classical")
        ]
        strongest.append(
            f"{row['fault']} {row['strengths'][-1]:g}: {shares[0]} ({shares[1]}) of all frames, "
            f"{shares[2]} ({shares[3]}) answered"
        )
    return (
        f" On {rows[0]['dataset']} under {len(rows)} faults of several strengths SSCNN, which "
        f"learned with them, errs less in {wins} of {len(met)} cases and more in {losses}. A "
        f"method that answers fewer than 95 % loses; in {seldom} of the {wins} that is all, the "
        f"pipeline's own answers are nearer. Without a fault the network is off by {clean[0]:.2g} "
        f"deg, the best pipeline by {clean[1]:.2g} deg. Off by more than 1 deg "
        f"without a flag under the strongest, in brackets the pipeline: {'; '.join(strongest)}."
    )


def _size(row: Row, way: str, at: int) -> float:
    return curve(row, way, "rms_deg")[at] or NONE_DEG
