"""What is wrong with a call, in the words of who made it."""

from __future__ import annotations

import re
from typing import Any

from pydantic import ValidationError

from api.cli.wrong_call import unfit
from survey_data.nearest import nearest_name

_CHOICES = re.compile(r"is not one of (?P<choices>'.+')\.$")
_PATH = re.compile(r"^(?:dir(?:ectory)?|file|path) '?(?P<path>.*?)'? is a (?P<kind>file|directory)")
_KINDS = {"file": "directory", "directory": "file"}
_EXPECTED = {
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_parsing": "a number",
    "bool_parsing": "true or false",
}
_LIMITS = {"ge": "at least {:g}", "gt": "more than {:g}", "le": "at most {:g}", "lt": "below {:g}"}


def usage_message(error: Any) -> str:
    """Return a usage error of Typer's as a sentence without the words of its machinery.

    Parameters
    ----------
    error : TyperException
    """
    message = str(error.format_message())
    extra = re.match(r"Got unexpected extra arguments? ?\(?s?\)? ?\((?P<what>.*)\)", message)
    if extra:
        return f"no argument expected here; got {extra['what']}"
    if message.startswith("No such command") and "Did you mean" not in message:
        return f"{message.rstrip('.')}; `{_path(error)} --help` lists them"
    param = getattr(error, "param", None)
    if param is None:
        return message.removeprefix("Invalid value: ")
    name = max(param.opts, key=len) if param.opts[0].startswith("-") else param.name.upper()
    cause = error.__cause__
    if isinstance(cause, ValidationError):
        return f"{name}: {_value(cause.errors()[0], str(error.message))}"
    found = _PATH.match(str(error.message))
    if found:
        kind = found["kind"]
        return f"{name}: {found['path']} is a {kind}; expected a {_KINDS[kind]}"
    return message


def _value(flaw: Any, message: str) -> str:
    """Return what is wrong with one value."""
    given = flaw["input"]
    choices = _CHOICES.search(message)
    if choices:
        words = re.findall(r"'([^']*)'", choices["choices"])
        near = nearest_name(str(given), words)
        return unfit(given, f"one of {', '.join(words)}", near)
    for limit, expected in _LIMITS.items():
        if limit in flaw.get("ctx", {}):
            return unfit(given, expected.format(flaw["ctx"][limit]))
    return unfit(given, _EXPECTED.get(flaw["type"], flaw["msg"]))


def _path(error: Any) -> str:
    return str(error.ctx.command_path) if error.ctx is not None else "sunatlas"
