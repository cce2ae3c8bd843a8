"""Networks on orbits and units they were not trained on, beside an albedo model and nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict

from benchmark.assessment.networks import NetworkError, fields, line, orbits, seeds, spans, units
from benchmark.results.row_file import Row
from benchmark.running.experiment import Report

_QUESTIONS: Mapping[str, Callable[[], Iterator[NetworkError]]] = {
    "orbits": orbits,
    "units": units,
    "seeds": seeds,
    "spans": spans,
    "fields": fields,
}


class Networks(Report[str]):
    """Answers to questions on neural networks, each with the cases measured."""

    name = "networks"

    def cells(self) -> Sequence[str]:
        """List the questions."""
        return list(_QUESTIONS)

    def tasks(self, cells: Sequence[str]) -> Sequence[str]:
        """Make a task of each question."""
        return cells

    @staticmethod
    def measure(task: str) -> list[tuple[str, Row]]:
        """Answer a question."""
        return [(task, {"cases": [asdict(one) for one in _QUESTIONS[task]()]})]

    def lines(self, rows: Mapping[str, Row]) -> Iterator[str]:
        """Yield a line a case and method."""
        for row in rows.values():
            yield from (line(NetworkError(**one)) for one in row["cases"])
