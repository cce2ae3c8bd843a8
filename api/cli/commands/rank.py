"""`sunatlas rank`: one algorithm checked, measured and shown on the board of a data set."""

from __future__ import annotations

from typing import Annotated

import typer

from api.cli.contract import GUIDE, check_contract, name_of
from api.cli.measuring import AVAILABLE_WORKERS, ManyWorkersOption, StoreOption, stores_of
from api.cli.options import complete
from api.cli.table_output import Format, FormatOption, emit, say
from api.schema import words
from api.schema.scores import LeaderboardRow
from api.schema.table import columns_of
from benchmark.leaderboard import candidate

COLUMNS = (
    *("new", "rank", "group", "extractor", "model", "own_error_deg", "low_deg", "high_deg"),
    *("on_bench_deg", "over_bound", "over_bound_unit", "availability", "false_detection_rate"),
)
#: Marks the rows of the algorithm.
MARK = "*"


def rank(
    algorithm: Annotated[
        str,
        typer.Argument(
            autocompletion=complete(words.ExtractorName),
            help="Name, such as tm, or file of the algorithm.",
        ),
    ],
    *,
    dataset: Annotated[
        str, typer.Option(autocompletion=complete(words.DatasetName), help="Data set.")
    ],
    workers: ManyWorkersOption = AVAILABLE_WORKERS,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Check and measure an algorithm, and show its rank.

    The algorithm is an extractor, model or compensation, given by name or file. It must pass the
    common tests; otherwise the failures are printed and nothing is measured. Its pipelines are then
    scored under the nominal condition; all other rows come from the published record. The
    leaderboard marks the new rows. New scores are kept in the local store (see --store).
    """
    name = name_of(algorithm)
    result = check_contract(name)
    if result is None:
        typer.echo("contract: not checked, the tests are in a checkout only", err=True)
    elif result.failures:
        for line in result.failures:
            typer.echo(f"contract: {line}", err=True)
        typer.echo(
            f"sunatlas: {name} fails {len(result.failures)} of {result.ran} checks; the rules are "
            f"in {GUIDE}",
            err=True,
        )
        raise typer.Exit(1)
    else:
        typer.echo(f"contract: {result.ran} checks passed", err=True)
    record, work = stores_of(store)
    ranked = candidate.rank(name, dataset, record, work, workers=workers)
    rows = [{**row, "new": MARK if ranked.has(row) else None} for row in ranked.rows]
    if form is Format.TABLE:
        shown = [row for row in rows if row["new"] or (row["best_of_extractor"] and row["rank"])]
        emit(shown, COLUMNS, form, title=f"{dataset}: best of each extractor, and {name} ({MARK})")
        say(ranked.scope)
    else:
        emit(
            rows,
            ("new", *columns_of(LeaderboardRow)),
            form,
            document={"items": rows, "scope": ranked.scope},
        )
    failed = [row for row in rows if row["new"] and row["reason"]]
    for row in failed:
        typer.echo(f"no score: {row['extractor']} + {row['model']}: {row['reason']}", err=True)
    typer.echo(f"{ranked.measured} cells measured now, kept in {work.directory}", err=True)
