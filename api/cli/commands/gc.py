"""`sunatlas gc`: delete unused results from the local store."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from api.cli.measuring import StoreOption, stores_of
from api.cli.table_output import Format, FormatOption, emit
from api.cli.wrong_call import WrongCallError
from benchmark.suites.tidying import tidy, would_tidy

COLUMNS = ("scores", "pins", "kept", "freed")


def gc(
    *,
    yes: Annotated[
        bool, typer.Option("--yes", help="Delete; otherwise only show what would be deleted.")
    ] = False,
    store: StoreOption = None,
    form: FormatOption = Format.TABLE,
) -> None:
    """Delete unused results from the local store.

    Unused: scores and hashes whose data set, extractor, model or measuring code has changed or no
    longer exists. Nothing is deleted without --yes. `freed` is in bytes.
    """
    published, there = stores_of(store)
    if there.directory.resolve() == published.directory.resolve():
        raise WrongCallError("the published results are no working store; `sunatlas leaderboard`")
    found = asdict(tidy(there) if yes else would_tidy(there))
    document = {"store": str(there.directory), "done": yes, **found}
    emit([found], COLUMNS, form, document=document)
    freed = f"{found['freed']:,} bytes"
    text = f"{freed} freed" if yes else f"{freed} to be freed; `sunatlas gc --yes` does it"
    typer.echo(f"{there.directory}: {text}", err=True)
