"""Settings that models choose from their calibration beside the best fixed ones in hindsight."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict

from benchmark.assessment.selection import NOMINAL, SETTINGS, WORST, Choice, choices
from benchmark.plan.combinations import cells
from benchmark.results.row_file import Row
from benchmark.running.experiment import Report


class Selection(Report[str]):
    """Choices of the models that select their own order, for each data set."""

    name = "selection"

    def cells(self) -> Sequence[str]:
        """List the data sets that such a model fits."""
        return sorted({cell.dataset for cell in cells(None, NOMINAL, None, list(SETTINGS))})

    def tasks(self, cells: Sequence[str]) -> Sequence[str]:
        """Make a task of each data set."""
        return cells

    @staticmethod
    def measure(task: str) -> list[tuple[str, Row]]:
        """Compare each choice with the best of the fixed settings."""
        return [(task, {"choices": [asdict(choice) for choice in choices([task])]})]

    def lines(self, rows: Mapping[str, Row]) -> Iterator[str]:
        """Yield a line a choice."""
        for one in _choices(rows):
            yield (
                f"{one.dataset} {one.extractor} {one.model} {one.ratio:.3f} {dict(one.chosen)} "
                f"{one.chosen_deg:.4g} {dict(one.best)} {one.best_deg:.4g}"
            )

    def passes(self, rows: Mapping[str, Row]) -> bool:
        """Say whether no choice is worse than `WORST`."""
        return all(choice.ratio <= WORST for choice in _choices(rows))


def _choices(rows: Mapping[str, Row]) -> Iterator[Choice]:
    return (Choice(**one) for row in rows.values() for one in row["choices"])
