"""The report of a calibration: one HTML file that needs nothing else."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from api.calibrate.calibration import Calibration
from api.calibrate.documents import selection_table
from api.calibrate.flight.code import FlightCode
from api.calibrate.pictures import pictures

_TEMPLATES = Path(__file__).parent


def report(found: Calibration, command: str = "", table: FlightCode | None = None) -> str:
    """Return the report as HTML text: the verdict first."""
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES), autoescape=True, undefined=StrictUndefined
    )
    environment.filters["deg"] = _deg
    counted = Counter(one.reason for one in found.excluded)
    return environment.get_template("report.html").render(
        found=found,
        verdict=found.verdict,
        rows=selection_table(found),
        pictures=pictures(found),
        excluded=counted.most_common(),
        listed=found.excluded[:200],
        table=table,
        command=command,
    )


def _deg(value: float | None) -> str:
    return "-" if value is None or value != value else f"{value:.3g} deg"  # noqa: PLR0124 - NaN
