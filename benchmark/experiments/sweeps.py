"""Error of every method, and its bound, over noise, feature size, sub-pixel phase and more."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cached_property, partial
from itertools import groupby

from benchmark.results.components import current
from benchmark.results.digests import series_digest, short_digest
from benchmark.results.modules import modules_digest
from benchmark.results.row_file import Row
from benchmark.running.experiment import RecordedExperiment
from benchmark.sweeps import plots
from benchmark.sweeps.measure import SweepTask, measure
from benchmark.sweeps.plan import SERIES, SweepPlan, plan_points
from benchmark.sweeps.points import Point
from benchmark.sweeps.record import RECORD, point_of

#: What measures a point, with the series and methods that it is handed.
_CODE = "benchmark.sweeps.measure"


def series_digests() -> dict[str, str]:
    """Digest of each series of synthetic features."""
    return {name: series_digest(series) for name, series in SERIES.items()}


class Sweeps(RecordedExperiment[Point]):
    """Error of every extractor as noise, background, size and other conditions change."""

    name = "sweeps"
    title = "Sweeps on synthetic features"
    record = RECORD

    @cached_property
    def plan(self) -> SweepPlan:
        """Settings by point, and reasons of what is not measured."""
        return plan_points(self.parts.extractors)

    def keys(self) -> Mapping[Point, str]:
        """Digest the code, series and extractor of each."""
        code, series = modules_digest(_CODE), series_digests()
        extractors = current(self.parts.of_extractors())
        return {
            point: short_digest(
                [
                    code,
                    series.get(point.series, ""),
                    extractors.digest("extractors", point.extractor),
                ]
            )
            for point in sorted({*self.plan.settings, *self.plan.refused})
        }

    def why_outdated(self, row: Row, key: str) -> str:
        """Say also that a row failed, or that the plan refuses it no more or otherwise."""
        if row["status"] == "failed":
            return "failed"
        reason = self.plan.refused.get(point_of(row))
        if (row["reason"] != reason) if reason else (not row["n"]):
            return "refused otherwise"
        return super().why_outdated(row, key)

    def pictures(self) -> Mapping[str, Callable[[], str]]:
        """Draw error against noise, size and phase."""
        return {f"error-against-{sweep}.svg": partial(self._draw, sweep) for sweep in plots.DRAWN}

    def _draw(self, sweep: str) -> str:
        return plots.picture(self.rows(), sweep)

    def name_of(self, cell: Point) -> str:
        """Return the extractor."""
        return cell.extractor

    def tasks(self, cells: Sequence[Point]) -> Iterator[SweepTask]:
        """Group methods that see the same observations."""
        for _, group in groupby(sorted(cells), key=lambda p: (p.series, p.sweep, p.point)):
            found = tuple(group)
            yield SweepTask(
                {point: self.parts.extractor(point.extractor) for point in found},
                next((self.plan.settings[p] for p in found if p in self.plan.settings), None),
                {p: self.plan.refused[p] for p in found if p in self.plan.refused},
            )

    @staticmethod
    def measure(task: SweepTask) -> list[tuple[Point, Row]]:
        """Draw a point's observations, extract with every method, compare."""
        return measure(task)
