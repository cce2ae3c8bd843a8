"""What it costs to follow an answer: its first calibration beside the best one by brute force."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median

from benchmark.assessment.regret import NUMBER, SAME, SEED, DrawnRequirement, regrets
from benchmark.contract import UnknownNameError
from benchmark.results.row_file import Row
from benchmark.results.store import Store
from benchmark.running.experiment import Report


class Regret(Report[int]):
    """A row of each draw, by its seed, which holds `NUMBER` requirement sets.

    A cell that is asked for may be any seed.
    """

    name = "regret"

    def cells(self) -> Sequence[int]:
        """List the one seed that is drawn by unasked."""
        return [SEED]

    def cells_named(self, names: Collection[str]) -> list[int]:
        """Return seeds; UnknownNameError for what is no whole number."""
        for name in names:
            if not name.isdecimal():
                raise UnknownNameError("seed", name, map(str, self.cells()))
        return [int(name) for name in names]

    def tasks(self, cells: Sequence[int]) -> Sequence[tuple[Path, int]]:
        """Make a task of each seed."""
        return [(self.directory, seed) for seed in cells]

    @staticmethod
    def measure(task: tuple[Path, int]) -> list[tuple[int, Row]]:
        """Answer drawn requirements, and look at every stored pipeline."""
        directory, seed = task
        return [(seed, {"drawn": list(regrets(Store(directory), NUMBER, seed))})]

    def lines(self, rows: Mapping[int, Row]) -> Iterator[str]:
        """Yield what was found of each draw, and each answer that tells another regret."""
        for seed, row in rows.items():
            yield from _lines(seed, row["drawn"])

    def passes(self, rows: Mapping[int, Row]) -> bool:
        """Say whether every answer tells the regret that brute force finds."""
        return all(one.is_consistent for row in rows.values() for one in row["drawn"])


def _lines(seed: int, found: Sequence[DrawnRequirement]) -> Iterator[str]:
    met = [one for one in found if math.isfinite(one.best_deg)]
    first = sum(math.isclose(one.first_deg["measured"], one.best_deg, rel_tol=SAME) for one in met)
    known = [one.stated_ratio["advice"] for one in met if one.stated_ratio["advice"] is not None]
    broken = [one for one in found if not one.is_consistent]
    owned = [one for one in met if not math.isnan(one.own_ratio)]
    there = sum(one.first_deg["advice"] <= 1.2 * one.best_there_deg for one in met)
    spread = _spread([ratio for ratio in known if ratio > 1.0])
    yield f"{len(found)} requirement sets (seed {seed}): {len(met)} are met by a measured pipeline"
    yield f"sort=measured: the first calibration is the most accurate one in {first} of {len(met)}"
    yield (
        f"sort=advice: the first calibration is the most accurate one in {known.count(1.0)}, and "
        f"is not measured or below 95 % availability in {len(met) - len(known)}; error ratio of "
        f"the others: {spread}"
    )
    yield (
        "sort=advice: its error is at most 1.2 times that of the best calibration of its "
        f"architecture in {there} of {len(met)}; by the measure of the tasks its architecture is "
        "within twice the best advised or studied one in "
        f"{sum(one.own_ratio <= 2.0 for one in owned)} of {len(owned)}"
    )
    yield f"the stated regret differs from that of brute force in {len(broken)} of {len(found)}"
    for one in broken:
        numbers = f"{one.first_deg}, best {one.best_deg}, stated {one.stated_ratio}"
        yield f"  {dict(one.requirements)}: {numbers}"


def _spread(ratios: Sequence[float]) -> str:
    if not ratios:
        return "no more"
    return f"{min(ratios):.3g} to {max(ratios):.3g} times as much (median {median(ratios):.3g})"
