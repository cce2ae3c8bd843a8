"""What the docs say of filters: published errors in orbit, beside models of single samples."""

from __future__ import annotations

from collections.abc import Mapping

from benchmark.contract import Cell
from benchmark.leaderboard.summaries import digits
from benchmark.plan.parts import installed_parts
from benchmark.results.csv_tables import Row
from benchmark.results.store import Store

#: Data sets with the extractor whose features are read, and the conditions shown.
SHOWN: Mapping[tuple[str, str], tuple[str, ...]] = {
    ("pd-orbit", "direct"): ("nominal", "no-albedo", "stable", "hot", "misaligned", "high-noise"),
    ("ccd-orbit", "bctm"): ("nominal", "stable", "hot", "misaligned", "high-noise"),
}
#: Models of single samples beside them, the best under the nominal condition.
_STILL = 3


def errors() -> str:
    """Tables of the RMS of unit 0, degrees, of filters and of the best other models."""
    scores = Store().scores()
    return "\n\n".join(_table(scores, *place, shown) for place, shown in SHOWN.items())


def _table(
    scores: Mapping[Cell, Row], dataset: str, extractor: str, conditions: tuple[str, ...]
) -> str:
    known = installed_parts().models
    filters = [name for name, model in known.items() if getattr(model, "sequential", False)]

    def error(model: str, condition: str) -> float | None:
        row = scores.get(Cell(dataset, condition, extractor, model))
        found = None if row is None else row["charged_deg"]
        return float(found) if isinstance(found, float | int) else None

    still = {name: error(name, "nominal") for name in known if name not in filters}
    best = sorted((value, name) for name, value in still.items() if value is not None)[:_STILL]
    lines = [
        f"### {dataset}, `{extractor}`",
        "",
        "| unit 0 RMS, deg | " + " | ".join(conditions) + " |",
        "|---|" + "---|" * len(conditions),
    ]
    for name in [*filters, *(name for _, name in best)]:
        cells = (error(name, condition) for condition in conditions)
        shown = ("–" if cell is None else digits(cell) for cell in cells)
        lines.append(f"| `{name}` | " + " | ".join(shown) + " |")
    return "\n".join(lines)
