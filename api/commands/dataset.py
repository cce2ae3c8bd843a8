"""`sunatlas dataset`: the standard data sets."""

from __future__ import annotations

from typing import Annotated

import typer

from api.commands.tables import Format, FormatOption, emit
from benchmark import datasets

app = typer.Typer(
    help="List or describe the standard datasets.", add_completion=False, rich_markup_mode=None
)

COLUMNS = ("name", "version", "detector", "mask", "observation", "conditions", "follows")
CONDITIONS = ("condition", "description")


@app.command("list")
def listing(form: FormatOption = Format.TABLE) -> None:
    """List the data sets: what sensor each simulates, under which conditions."""
    cards = [datasets.get(name).card() for name in datasets.names()]
    rows = [{**card, "conditions": list(card["conditions"])} for card in cards]
    emit(rows, COLUMNS, form, title=f"{len(cards)} data sets")


@app.command()
def describe(
    name: Annotated[str, typer.Argument(help="Name of the data set.")],
    form: FormatOption = Format.TABLE,
) -> None:
    """Describe one data set: its card; as JSON with every parameter its numbers depend on."""
    card = datasets.get(name).card()
    conditions = card["conditions"]
    if form is Format.TABLE:
        typer.echo(f"{card['name']} (version {card['version']}): {card['description']}")
        typer.echo(f"{card['detector']}, {card['mask']}; gives {card['observation']}")
        typer.echo(f"follows {', '.join(card['follows'])}\n")
    rows = [{"condition": key, **described} for key, described in conditions.items()]
    emit(rows, CONDITIONS, form, document=card)
