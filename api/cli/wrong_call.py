"""The error of a call that cannot be right, whatever the data say."""

from __future__ import annotations

import typer


class WrongCallError(typer.TyperException):
    """The call is wrong: exit code 2."""

    exit_code = 2


def given(context: typer.Context) -> list[str]:
    """Return the options that a call has, by their names there."""
    return [
        max(one.opts, key=len)
        for one in context.command.params
        if one.opts[0].startswith("-") and _is_stated(context, str(one.name))
    ]


def _is_stated(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def only_beside(context: typer.Context, what: str, *allowed: str) -> None:
    """Refuse the options of a call, but those allowed, that do not apply beside `what`."""
    if others := [name for name in given(context) if name not in {what, *allowed}]:
        raise WrongCallError(f"{what} goes without {', '.join(others)}")


def unfit(value: object, expected: str, nearest: str | None = None) -> str:
    """Say that a value does not fit, and what would; `nearest` is the valid value most like it."""
    if value is None:
        return f"expected {expected}"
    text = f"{value:g}" if isinstance(value, float) else str(value)
    try:
        number = float(text)
    except ValueError:
        got = repr(text)
    else:
        got = f"{number:.15g}"
    if nearest is not None:
        return f"no {got}; did you mean {nearest!r}?"
    return f"got {got}; expected {expected}"
