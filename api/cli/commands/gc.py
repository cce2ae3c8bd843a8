"""`sunatlas gc`: what no cell refers to, dropped from the working store."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from api.cli.measuring import StoreOption, stores_of
from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from benchmark.suites.tidying import tidy, would_tidy

app = typer.Typer(add_completion=False, rich_markup_mode=None)

COLUMNS = ("scores", "pins", "times", "kept", "freed")


@app.command()
def gc(
    *,
    yes: Annotated[
        bool, typer.Option("--yes", help="Do it; without, only tell what would be done.")
    ] = False,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Drop from the working store what no cell refers to.

    Scores, pins of data and times whose data set, extractor, model or harness has changed or is
    gone: they are never read again. Scores of today's code stay (kept), and so does whatever else
    lies in the directory. Without --yes nothing is changed. Freed is in bytes.
    """
    published, there = stores_of(store)
    if there.directory.resolve() == published.directory.resolve():
        raise WrongCallError("the published results are no working store; `sunatlas leaderboard`")
    found = asdict(tidy(there) if yes else would_tidy(there))
    document = {"store": str(there.directory), "done": yes, **found}
    emit([found], COLUMNS, form, document=document)
    freed = f"{found['freed']:,} bytes"
    told = f"{freed} freed" if yes else f"{freed} to be freed; `sunatlas gc --yes` does it"
    typer.echo(f"{there.directory}: {told}", err=True)
