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
    """Refuse the options of a call that would be passed over in silence.

    Parameters
    ----------
    context : of the call
    what : the option or argument that the others do not apply to
    allowed : options that do
    """
    if others := [name for name in given(context) if name not in {what, *allowed}]:
        raise WrongCallError(f"{what} goes without {', '.join(others)}")


def refuse(name: str, value: object, expected: str, nearest: str | None = None) -> WrongCallError:
    """Return the error of a value of an option.

    Parameters
    ----------
    name : of the option, or of the parameter of the service that it stands for
    value : what was given
    expected : what would have been right, in words
    nearest : the valid value most like it, if any
    """
    option = f"--{name.replace('_', '-')}"
    return WrongCallError(f"{option}: {unfit(value, expected, nearest)}")


def unfit(value: object, expected: str, nearest: str | None = None) -> str:
    """Say that a value does not fit, and what would; parameters as of `refuse`."""
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
