"""Scores of models on real readings, kept beside those on the standard data sets.

The readings are not bundled, so the scores are: `measured` makes them again of what is fetched.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from api.real.sets import RealSet
from calibrate.likeness import alike
from files.reading import read_text

_PATH = Path(__file__).parent / "scores.csv"
COLUMNS = ("set", "model", "rms_deg", "standard_error_deg", "worst_run_deg", "unanswered")


def measured(real: RealSet, directory: Path) -> list[dict[str, Any]]:
    """Return the score of every model that answers on a set's files, the smallest error first.

    Returns
    -------
    list of dict
        Of runs left out one by one, wrong poses and clear mistakes of convention put right, as
        `sunatlas calibrate --apply` does; four digits.
    """
    from calibrate.calibration import calibrate  # noqa: PLC0415 - SciPy

    runs = [directory / source.written for source in real.sources if source.blocks]
    found = calibrate(runs, apply=True)
    return [
        {
            "set": real.name,
            "model": one.name,
            "rms_deg": _digits(one.rms_deg),
            "standard_error_deg": _digits(one.spread_deg),
            "worst_run_deg": _digits(one.worst_deg),
            "unanswered": _digits(one.missing),
        }
        for one in found.candidates
        if not one.refused
    ]


def kept(name: str) -> list[dict[str, Any]]:
    """Return the kept scores of a set, by its name."""
    lines = read_text(_PATH, 1_000_000).splitlines()
    rows = [dict(zip(COLUMNS, line.split(","), strict=True)) for line in lines[1:]]
    return [
        {key: value if key in COLUMNS[:2] else float(value) for key, value in row.items()}
        for row in rows
        if row["set"] == name
    ]


def beside_standard(
    name: str, nominal: Mapping[tuple[str, str, str], Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Return the kept scores of a set, and beside each that on the standard set most alike.

    With the factor by which ratios between models differ there, see `calibrate.likeness`.

    Parameters
    ----------
    name : str
        Of the set of real readings.
    nominal : mapping
        Published scores by data set, extractor and model.
    """
    rows = kept(name)
    ranked = alike({row["model"]: row["rms_deg"] for row in rows}, nominal)
    nearest = ranked[0] if ranked else None
    return [
        {
            **row,
            "dataset": nearest.dataset if nearest else None,
            "extractor": nearest.extractor if nearest else None,
            "dataset_own_error_deg": nearest.errors_deg.get(row["model"]) if nearest else None,
            "factor": round(nearest.factor, 2) if nearest else None,
        }
        for row in rows
    ]


def _digits(value: float) -> float:
    return float(f"{value:.4g}")
