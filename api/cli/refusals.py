"""What is wrong with a call: Typer's sentence, with the value that came."""

from __future__ import annotations

import re
from typing import Any

from pydantic import ValidationError

_PATH = re.compile(r"^(?:dir(?:ectory)?|file|path) '?(?P<path>.*?)'? is a (?P<kind>file|directory)")
_KINDS = {"file": "directory", "directory": "file"}
_EXPECTED = "Input should be "


def usage_message(error: Any) -> str:
    """Return a usage error of Typer's (`typer.TyperException`) as a sentence for the caller."""
    message = str(error.format_message())
    extra = re.match(r"Got unexpected extra arguments? ?\(?s?\)? ?\((?P<what>.*)\)", message)
    if extra:
        return f"no argument expected here; got {extra['what']}"
    if message.startswith("No such command") and "Did you mean" not in message:
        path = error.ctx.command_path if error.ctx is not None else "sunatlas"
        return f"{message.rstrip('.')}; `{path} --help` lists them"
    param = getattr(error, "param", None)
    if param is None:
        return message.removeprefix("Invalid value: ")
    name = max(param.opts, key=len) if param.opts[0].startswith("-") else param.name.upper()
    if isinstance(error.__cause__, ValidationError):
        flaw = error.__cause__.errors()[0]
        said = flaw["msg"].removeprefix("Value error, ").partition(", unable")[0].rstrip(".")
        if said.startswith(_EXPECTED):
            said = f"got {flaw['input']!r}; expected {said.removeprefix(_EXPECTED)}"
        return f"{name}: {said}"
    if found := _PATH.match(str(error.message)):
        return f"{name}: {found['path']} is a {found['kind']}; expected a {_KINDS[found['kind']]}"
    return message
