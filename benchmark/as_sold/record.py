"""The published simulations of built sensors: a row each, and what they say beside the figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from benchmark.results.csv_tables import Reader, above_zero, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import PUBLISHED

#: Within this factor of the stated figure a simulation agrees.
FACTOR = 2.0
#: Depth and bench of the errors of a row; without a calibration there is no bench.
CELLS = ("none", "constants_standard", "constants_fine", "table_standard", "table_fine")
_WORDS = {
    "none": "uncalibrated",
    "constants_standard": "with constants of the unit",
    "constants_fine": "with constants of the unit from the fine bench",
    "table_standard": "with a table of the unit",
    "table_fine": "with a table of the unit from the fine bench",
}

COLUMNS: Mapping[str, Reader] = {
    "hardware": word,
    "dataset": word,
    "half_fov_deg": above_zero,
    "level": word,
    "statistic": word,
    "constants": str,
    "table": str,
    **{f"{cell}_deg": above_zero for cell in CELLS},
}


class SharedFacts(BaseModel, extra="forbid"):
    """What a row was measured with."""

    key: str


def _hardware(row: Row) -> str:
    return str(row["hardware"])


RECORD = TableFile("as_sold.csv", COLUMNS, SharedFacts, _hardware, _hardware, _hardware)


def beside_stated(directory: Path | str = PUBLISHED) -> list[dict[str, Any]]:
    """Return each simulated sensor beside its stated figure, by id.

    ``simulated_deg`` is that at the depth and on the bench of `mapping.as_sold`, ``ratio`` over the
    stated one; ``reason`` says of a ratio beyond `FACTOR` which other cells of the row are within.
    """
    from benchmark.as_sold.mapping import as_sold  # noqa: PLC0415 - loads the simulator

    found = []
    for row in RECORD.read(directory).values():
        one = as_sold().get(row["hardware"])
        if one is None:
            continue
        cell = "none" if one.depth == "none" else f"{one.depth}_{one.bench}"
        simulated, stated = row[f"{cell}_deg"], one.sensor.accuracy_deg
        ratio = None if simulated is None or not stated else simulated / stated
        found.append(
            {
                "hardware": row["hardware"],
                "name": one.sensor.name,
                "detector": one.sensor.detector,
                "mask": one.sensor.mask,
                "depth": one.depth,
                "depth_basis": one.depth_basis,
                "bench": None if one.depth == "none" else one.bench,
                "stated_deg": stated,
                "simulated_deg": simulated,
                "ratio": ratio,
                "agrees": None if ratio is None else 1.0 / FACTOR <= ratio <= FACTOR,
                "reason": _reason(row, cell, stated, ratio),
                **{name: row[name] for name in COLUMNS if name != "hardware"},
            }
        )
    return found


def _reason(row: Row, cell: str, stated: float | None, ratio: float | None) -> str:
    """Say which other runs of a sensor agree where its own does not."""
    if ratio is None or not stated:
        return "no pipeline of this kind answers"
    if 1.0 / FACTOR <= ratio <= FACTOR:
        return ""
    within = [
        f"{_WORDS[other]} {row[f'{other}_deg']:.2g} deg"
        for other in CELLS
        if other != cell and _agrees(row[f"{other}_deg"], stated)
    ]
    if within:
        return f"within a factor of {FACTOR:g}: {'; '.join(within)}"
    known = [row[f"{other}_deg"] for other in CELLS if row[f"{other}_deg"] is not None]
    return (
        f"neither depth nor bench explains it: {min(known):.2g} to {max(known):.2g} deg over all "
        "of them"
    )


def _agrees(simulated: float | None, stated: float) -> bool:
    return simulated is not None and 1.0 / FACTOR <= simulated / stated <= FACTOR


def tally(rows: list[dict[str, Any]]) -> str:
    """Say how many sensors agree with their stated figure."""
    return " ".join(_tally(rows))


def _tally(rows: list[dict[str, Any]]) -> Iterator[str]:
    near = sum(bool(row["agrees"]) for row in rows)
    yield f"{near} of {len(rows)} built sensors are within a factor of {FACTOR:g} of their figure."
    stated = [row for row in rows if row["depth_basis"] != "assumed"]
    near = sum(bool(row["agrees"]) for row in stated)
    yield f"Of the {len(stated)} whose depth of calibration is known, {near} are."
