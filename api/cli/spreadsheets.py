"""`--safe`: CSV that a spreadsheet can open, of every command that has `--format`."""

from __future__ import annotations

from collections.abc import Callable
from contextvars import ContextVar
from functools import wraps
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from api.cli.wrong_call import WrongCallError
from files.csv_writing import escape_formulas

HELP = "With --format csv: escape cells that a spreadsheet would run as formulas."

_WANTED: ContextVar[bool] = ContextVar("safe", default=False)


def as_asked(text: str) -> str:
    """Return CSV as the running command is to write it."""
    return escape_formulas(text) if _WANTED.get() else text


def offer(command: Any) -> None:
    """Give `--safe` to a command that has `--format`, and to each of its subcommands that has."""
    if any(parameter.name == "form" for parameter in command.params):
        command.params.append(_option())
        command.callback = _of_csv_alone(command.callback)
    if isinstance(command, TyperGroup):
        for member in command.commands.values():
            offer(member)


def _keep(value: bool) -> bool:
    _WANTED.set(value)
    return value


def _option() -> Any:
    """Return the option as Typer makes it; commands do not see it."""
    one = typer.Typer(add_completion=False)

    @one.command()
    def _(
        safe: Annotated[
            bool, typer.Option("--safe", help=HELP, callback=_keep, expose_value=False)
        ] = False,
    ) -> None: ...

    made: TyperCommand = typer.main.get_command(one)  # type: ignore[assignment]
    return made.params[0]


def _of_csv_alone(run: Callable[..., Any]) -> Callable[..., Any]:
    """Return a command that refuses `--safe` where it prints no CSV."""

    @wraps(run)
    def checked(*given: Any, **options: Any) -> Any:
        file = options.get("out")
        if _WANTED.get() and options["form"] != "csv" and getattr(file, "suffix", "") != ".csv":
            raise WrongCallError("--safe needs --format csv")
        return run(*given, **options)

    return checked
