"""`sunatlas dataset`: the standard data sets."""

from __future__ import annotations

from typing import Annotated

import typer

from api.commands.asking import knowledge
from api.commands.tables import Format, FormatOption, emit
from benchmark import datasets

app = typer.Typer(
    help="List or describe the standard datasets.", add_completion=False, rich_markup_mode=None
)

COLUMNS = ("name", "version", "detector", "mask", "observation", "conditions", "follows")
CONDITIONS = ("condition", "bound_deg", "description")


@app.command("list")
def listing(form: FormatOption = Format.TABLE) -> None:
    """List the data sets: what sensor each simulates, under which conditions."""
    cards = knowledge().measurements.cards
    emit(cards, COLUMNS, form, title=f"{len(cards)} data sets")


@app.command()
def describe(
    name: Annotated[str, typer.Argument(help="Name of the data set.")],
    form: FormatOption = Format.TABLE,
) -> None:
    """Describe one data set: its card, with the published Cramer-Rao bound of each condition.

    As JSON with every parameter that its numbers depend on.
    """
    datasets.get(name)  # refuses an unknown name with the nearest one
    card = next(card for card in knowledge().measurements.cards if card["name"] == name)
    if form is Format.TABLE:
        typer.echo(f"{card['name']} (version {card['version']}): {card['description']}")
        typer.echo(f"{card['detector']}, {card['mask']}; gives {card['observation']}")
        typer.echo(f"follows {', '.join(card['follows'])}\n")
    rows = [
        {"condition": key, "bound_deg": card["bounds"].get(key), **setup}
        for key, setup in card["setups"].items()
    ]
    emit(rows, CONDITIONS, form, document=card)
