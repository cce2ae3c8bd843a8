"""The suites, all of them here: a name, what it is for, and the rule that selects its cells.

A suite is a rule and not a list, so that a new algorithm or data set takes its place without being
entered anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING, Any

from benchmark.contract import Cell, UnknownNameError

if TYPE_CHECKING:
    from benchmark.plan.parts import Parts

Scores = Mapping[Cell, Mapping[str, Any]]

#: Data sets that `quick` does without: their light alone takes 41 and 10 s of a processor, all
#: others' together 57 s, and every method reads another one as well.
NOT_QUICK = frozenset({"cmos-encoded-sizes", "cmos-multi-aperture"})


@dataclass(frozen=True)
class Suite:
    """A named selection of cells.

    `select` goes from the scores that are known and what is installed to its cells, in order. More
    scores may select more: what is worth measuring can depend on what was measured.
    """

    name: str
    what: str
    select: Callable[[Scores, Parts], list[Cell]]


def _quick(_scores: Scores, parts: Parts) -> list[Cell]:
    """Select every standard data set but slow ones, on them every extractor and model once.

    Under the first condition, on the standard unit; each on the first data set that it fits, in
    order of names: an extractor before the first model, a model behind an extractor that is read
    there already. A data set with nothing of its own has its first pipeline.
    """
    from benchmark.leaderboard import scope  # noqa: PLC0415 - slow, for who wants names alone
    from benchmark.plan.parts import Parts, split_parts  # noqa: PLC0415 - as above

    known = split_parts(parts)[0].presets
    quick = {name: preset for name, preset in known.items() if name not in NOT_QUICK}
    plan = scope.first(Parts(quick, parts.extractors, parts.models))
    found: dict[Cell, None] = {}
    extractors: set[str] = set()
    for _, cells in groupby(plan, key=lambda cell: (cell.dataset, cell.extractor)):
        first = next(cells)
        if first.extractor not in extractors:
            extractors.add(first.extractor)
            found[first] = None
    read = {(cell.dataset, cell.extractor) for cell in found}
    models = {cell.model for cell in found}
    for dataset, cells in groupby(plan, key=lambda cell: cell.dataset):
        board = sorted(cells, key=lambda cell: ((dataset, cell.extractor) not in read, cell))
        for cell in board:
            if cell.model not in models:
                models.add(cell.model)
                found[cell] = None
        if not any(cell.dataset == dataset for cell in found):
            found[board[0]] = None
    return sorted(found)


def _standard(scores: Scores, parts: Parts) -> list[Cell]:
    """Select all that is published, by the rule of `benchmark.leaderboard.scope`.

    On sensors of single studies, of these studies' pipelines.
    """
    from benchmark.leaderboard import scope, study_record  # noqa: PLC0415 - as above
    from benchmark.plan.parts import split_parts  # noqa: PLC0415 - as above

    standard, studies = split_parts(parts)
    return sorted(
        scope.published_scope(scores, standard) | study_record.published_scope(scores, studies)
    )


SUITES: Mapping[str, Suite] = {
    suite.name: suite
    for suite in (
        Suite("quick", "every extractor and model once, in less than a minute", _quick),
        Suite("standard", "all that is published", _standard),
    )
}


def suite(name: str) -> Suite:
    """Return the suite of that name; UnknownNameError otherwise."""
    if name not in SUITES:
        raise UnknownNameError("suite", name, SUITES)
    return SUITES[name]
