"""Whether a network finds the Sun's image where thresholds fail: by the rule of its direction."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtr

from benchmark.directions.duels import CHANCE, FEWEST_TOLD
from benchmark.directions.trials import Trial, not_tried
from benchmark.segmentation.frames import ONE_SUN, UNANSWERABLE
from benchmark.segmentation.worth import fault_of, leaders, member, pooled, worths

Row = Mapping[str, Any]

#: Worth below which thresholds fail, by how much another has to be worth more, and share of frames
#: without one Sun that may be answered.
FAILS, MARGIN, ANSWERED = 0.95, 0.03, 1e-3
#: Share of wins or losses that decides.
_MOST = 0.75


class _Cell(NamedTuple):
    """A data set under a fault where thresholds fail: both members, their worth, the outcome."""

    dataset: str
    fault: str
    classical: tuple[str, float]
    learned: tuple[str, float]
    outcome: str


def segmented(rows: Sequence[Row]) -> Trial:
    """Decide by the rows of the experiment."""
    if not rows:
        return not_tried(rows)
    cells = [cell for row in rows for cell in _cells(row)]
    wins, losses, void = (
        sum(cell.outcome == name for cell in cells) for name in ("win", "loss", "void")
    )
    told, verdict = wins + losses, "depends on the data set"
    if told < FEWEST_TOLD:
        verdict = "open"
    elif wins >= _MOST * told:
        verdict = "pays"
    elif losses >= _MOST * told:
        verdict = "does not pay"
    text = (
        f"Thresholds, templates and extractors fail in {len(cells)} of "
        f"{len(rows) * len(ONE_SUN)} cases (a data set under a fault). Under the U-Net's mask the "
        f"same readers are worth more in {wins + void} and less in {losses}"
    )
    if void:
        boards = sorted({cell.dataset for cell in cells if cell.outcome == "void"})
        text += (
            f"; {void} do not count, as the U-Net answers more than 0.1 % of frames without a Sun "
            f"or with two: {', '.join(boards)}"
        )
    text += f". {_extreme(cells)}{_overlaps(rows)}{_unanswerable(rows)}"
    return Trial(verdict, text, round(wins / told, 4) if told else None, _MOST, "share of wins")


def _cells(row: Row) -> list[_Cell]:
    found, quoted = [], set()
    for name in ONE_SUN:
        fault = fault_of(row, name)
        classical, learned = (member(row, fault, learned=one) for one in (False, True))
        quoted.add(learned["method"])
        one, other = (worths(row, of, scoring=True) for of in (classical, learned))
        if one.mean() < FAILS:
            means = [
                (of["method"], float(worth.mean()))
                for of, worth in ((classical, one), (learned, other))
            ]
            found.append(_Cell(row["dataset"], name, means[0], means[1], _outcome(other - one)))
    if not _refuses(row, quoted):
        found = [cell._replace(outcome="void") if cell.outcome == "win" else cell for cell in found]
    return found


def _outcome(gains: Any) -> str:
    mean = float(np.mean(gains))
    if abs(mean) <= MARGIN:
        return "tie"
    scatter = float(np.std(gains, ddof=1)) / math.sqrt(len(gains))
    beyond = (abs(mean) - MARGIN) / max(scatter, 1e-9)
    if float(stdtr(len(gains) - 1, -beyond)) >= CHANCE / 2.0:
        return "tie"
    return "win" if mean > 0 else "loss"


def _refuses(row: Row, quoted: set[str]) -> bool:
    """Say whether the members that are quoted answer few enough frames without one Sun."""
    return all(
        one["answered"] <= ANSWERED * one["frames"]
        for name in UNANSWERABLE
        for one in pooled(row, fault_of(row, name))
        if one["method"] in quoted
    )


def _extreme(cells: Sequence[_Cell]) -> str:
    """Name the largest gain and the largest loss."""
    ordered = sorted(cells, key=lambda cell: cell.learned[1] - cell.classical[1])
    ends = dict.fromkeys([ordered[-1], ordered[0]]) if ordered else {}
    return "".join(
        f"{cell.dataset} under {cell.fault}: {cell.learned[1]:.2f} ({cell.learned[0]}) against "
        f"{cell.classical[1]:.2f} ({cell.classical[0]}). "
        for cell in ends
    )


def _overlaps(rows: Sequence[Row]) -> str:
    """Compare the overlap of masks with the Sun's own pixels."""
    masks = [
        (one["learned"], one["overlap"])
        for row in rows
        for name in ONE_SUN
        for one in fault_of(row, name)["methods"]
        if one["overlap"] is not None
    ]
    means = [float(np.mean([of for by, of in masks if by == learned])) for learned in (True, False)]
    return (
        f"Its masks share {100 * means[0]:.0f} % of their pixels with the Sun's own, masks of "
        f"thresholds and templates {100 * means[1]:.0f} % (intersection over union, mean). "
    )


def _unanswerable(rows: Sequence[Row]) -> str:
    """Count answers to no Sun and to two, over the data sets."""
    said = []
    for name, of in zip(UNANSWERABLE, ("without a Sun", "with two"), strict=True):
        pairs = [leaders(row, fault_of(row, name)) for row in rows]
        bare, masked = (
            100.0 * sum(one["answered"] for one in side) / sum(one["frames"] for one in side)
            for side in zip(*pairs, strict=True)
        )
        said.append(
            f"Of frames {of} the leading extractors answer {bare:.1f} % bare and {masked:.1f} % "
            "under the U-Net's mask."
        )
    return " ".join(said)
