"""The published simulations of built sensors: a row each, and what they say beside the figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from benchmark.as_sold.cells import CELLS
from benchmark.results.csv_tables import Reader, above_zero, word
from benchmark.results.row_file import Row, TableFile
from benchmark.results.store import PUBLISHED

#: Within this factor of the stated figure a simulation agrees.
FACTOR = 2.0
_WORDS = {
    "uncalibrated": "no calibration",
    "constants": "constants of the unit",
    "table": "a table",
}
_BENCHES = {"standard": "standard bench", "fine": "fine bench", "true": "true directions"}

COLUMNS: Mapping[str, Reader] = {
    "hardware": word,
    "dataset": word,
    "half_fov_deg": above_zero,
    "level": word,
    "statistic": word,
    "constants": str,
    "table": str,
    **{f"{cell}_deg": above_zero for cell in CELLS},
    "other_level_deg": above_zero,
    "without_earth_deg": above_zero,
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
    stated one; ``reason`` says of a ratio beyond `FACTOR` which other runs of the row are within.
    """
    from benchmark.as_sold.mapping import as_sold  # noqa: PLC0415 - loads the simulator

    found = []
    for row in RECORD.read(directory).values():
        one = as_sold().get(row["hardware"])
        if one is None:
            continue
        simulated, stated = row[f"{one.cell}_deg"], one.sensor.accuracy_deg
        ratio = None if simulated is None or not stated else simulated / stated
        found.append(
            {
                "hardware": row["hardware"],
                "name": one.sensor.name,
                "detector": one.sensor.detector,
                "mask": one.sensor.mask,
                "depth": one.depth,
                "depth_basis": one.depth_basis,
                "bench": None if one.depth == "uncalibrated" else one.bench,
                "stated_deg": stated,
                "simulated_deg": simulated,
                "ratio": ratio,
                "agrees": None if ratio is None else 1.0 / FACTOR <= ratio <= FACTOR,
                "reason": _reason(row, one.cell, stated, ratio),
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
    others = {_named(name): row[f"{name}_deg"] for name in CELLS if name != cell}
    others["on the ground" if row["level"] == "flight" else "in flight"] = row["other_level_deg"]
    others["in flight without light from the Earth"] = row["without_earth_deg"]
    within = [
        f"{words} {error:.2g} deg"
        for words, error in others.items()
        if error is not None and 1.0 / FACTOR <= error / stated <= FACTOR
    ]
    if within:
        return f"within a factor of {FACTOR:g}: {'; '.join(within)}"
    known = [error for error in (row[f"{cell}_deg"], *others.values()) if error is not None]
    return (
        f"neither depth, bench nor level explains it: {min(known):.2g} to {max(known):.2g} deg in "
        "all runs"
    )


def _named(cell: str) -> str:
    depth, _, bench = cell.partition("_")
    return f"{_WORDS[depth]}, {_BENCHES[bench]}" if bench else _WORDS[depth]


def tally(rows: list[dict[str, Any]]) -> str:
    """Say how many sensors agree with their stated figure."""
    return " ".join(_tally(rows))


def _tally(rows: list[dict[str, Any]]) -> Iterator[str]:
    near = sum(bool(row["agrees"]) for row in rows)
    yield f"{near} of {len(rows)} built sensors are within a factor of {FACTOR:g} of their figure."
    stated = [row for row in rows if row["depth_basis"] != "assumed"]
    near = sum(bool(row["agrees"]) for row in stated)
    yield f"Of the {len(stated)} whose depth of calibration is known, {near} are."
