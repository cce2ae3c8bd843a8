"""The error of a call that cannot be right, whatever the data say."""

from __future__ import annotations

import typer


class WrongCallError(typer.TyperException):
    """The call is wrong: exit code 2."""

    exit_code = 2
