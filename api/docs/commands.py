"""Commands that pages show, run in this process: `sunatlas`, `curl` to the service, `cat`, `ls`."""

from __future__ import annotations

import asyncio
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

#: Columns of the terminal that pages are written for.
WIDTH = "88"
#: Where the pages' service listens.
SERVED = "http://127.0.0.1:8000"


class CommandError(Exception):
    """A command fails, or is none that pages may show; the message says which."""


def run(words: list[str]) -> str:
    """Run a command in the working directory; return what it prints, blanks at line ends cut.

    Raises
    ------
    CommandError
        Where it fails or is not known here.
    """
    name, *rest = words
    match name.removeprefix(".venv/bin/"):
        case "sunatlas":
            said = _sunatlas(rest)
        case "curl":
            said = _curl(rest)
        case "cat":
            said = "".join(Path(one).read_text("utf-8") for one in rest)
        case "ls":
            places = [Path(one) for one in rest] or [Path()]
            said = "".join(f"{p.name}\n" for place in places for p in sorted(place.iterdir()))
        case _:
            raise CommandError(f"expected sunatlas, curl, cat or ls; got {name}")
    return "".join(f"{line.rstrip()}\n" for line in said.strip("\n").splitlines())


def _sunatlas(arguments: list[str]) -> str:
    from typer.testing import CliRunner  # noqa: PLC0415 - with the whole command line

    from api.cli.command_line import app  # noqa: PLC0415

    runner = CliRunner(env={"COLUMNS": WIDTH, "TERMINAL_WIDTH": WIDTH})
    done = runner.invoke(app, arguments, prog_name="sunatlas")
    if done.exit_code:
        raise CommandError(f"exit code {done.exit_code}: {done.output.strip()}")
    return done.stdout


@cache
def _service() -> Any:
    from api.server.app import create_app  # noqa: PLC0415

    return create_app()


def _curl(arguments: list[str]) -> str:
    """Ask the service in this process; -H gives a header, -s and -i are taken."""
    import httpx  # noqa: PLC0415 - needed to write the docs, not to run the service

    headers, targets = {}, []
    given = iter(arguments)
    for word in given:
        if word == "-H":
            name, _, value = next(given).partition(":")
            headers[name.strip()] = value.strip()
        elif not word.startswith("-"):
            targets.append(word)
    (target,) = targets
    if not target.startswith(SERVED):
        raise CommandError(f"expected an address at {SERVED}; got {target}")
    parts = urlsplit(target)

    async def exchange() -> httpx.Response:
        transport = httpx.ASGITransport(_service())
        async with httpx.AsyncClient(transport=transport, base_url=SERVED) as client:
            path = parts.path + (f"?{parts.query}" if parts.query else "")
            return await client.get(path, headers=headers)

    answer = asyncio.run(exchange())
    if answer.status_code != 200:
        raise CommandError(f"{answer.status_code}: {answer.text}")
    return answer.text
