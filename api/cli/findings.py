"""`sunatlas leaderboard findings`: the findings of the published record, and their pairs."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit, say
from api.cli.wrong_call import WrongCallError

#: Columns of the estimates; `low` to `high` is the 95 % interval.
COLUMNS = ("finding", "estimate", "kind", "value", "low", "high", "n", "of")
#: As `benchmark.leaderboard.findings.KEYS`, which takes seconds to import.
NAMES = ("methods", "constants", "benches", "sources", "poses")


def findings(
    finding: Annotated[
        str | None, typer.Argument(help=f"Finding whose pairs to print: {', '.join(NAMES)}.")
    ] = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Show what the published record shows, with 95 % intervals; or the pairs of one finding.

    Each finding compares pairs: two methods on the same samples, or one method under two
    calibrations. JSON and CSV list its estimates: medians with intervals by order statistics,
    shares with those of Clopper and Pearson. With a name, the pairs are printed.
    """
    if finding is not None and finding not in NAMES:
        raise WrongCallError(f"no finding {finding!r}; expected one of {', '.join(NAMES)}")
    from api.cli.asking import knowledge  # noqa: PLC0415 - slow
    from api.service import leaderboard  # noqa: PLC0415 - as above

    every = {one.key: one for one in leaderboard.findings(knowledge())}
    if finding is not None:
        pairs = every[finding].pairs
        emit(pairs, tuple(pairs[0]), form, title=every[finding].title)
    elif form is Format.TABLE:
        for place, one in enumerate(every.values(), start=1):
            say(f"{place}. {one.title} {one.details} Pairs: `{one.command}`", "   ")
    else:
        rows = [{"finding": one.key, **e.row()} for one in every.values() for e in one.estimates]
        emit(rows, COLUMNS, form)
