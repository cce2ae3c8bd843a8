"""`sunatlas get`: an address of the HTTP interface, answered in this process."""

from __future__ import annotations

import asyncio
import csv
import io
import json
import sys
from collections.abc import Mapping
from typing import Annotated

import typer

from api.cli.table_output import Format, FormatOption, emit, emit_csv
from api.cli.wrong_call import WrongCallError

_ACCEPT = {Format.TABLE: b"text/csv", Format.CSV: b"text/csv", Format.JSON: b"application/json"}


def get(
    address: Annotated[
        str, typer.Argument(help="Address, such as '/v1/flows/error?task=Accuracy'.")
    ],
    form: FormatOption = Format.TABLE,
) -> None:
    """Answer an address of the HTTP API without a server.

    JSON and CSV are byte for byte those of the service; /docs of the service lists them. Useful
    for addresses without a command: /v1/taxonomy, /v1/algorithms, /v1/flows/error, /v1/sweeps,
    /v1/search. The JSON of a long list has the address of its next page.
    """
    from api.cli.asking import knowledge  # noqa: PLC0415 - slow; the help does without it
    from api.server.app import create_app  # noqa: PLC0415
    from api.web.asking import fetch_answer  # noqa: PLC0415

    path, _, query = address.partition("?")
    if not path.startswith("/"):
        path = f"/{path}"
    status, body = asyncio.run(fetch_answer(create_app(knowledge()), path, query, _ACCEPT[form]))
    if status != 200:
        raise WrongCallError(f"{path}: {_why(body)}")
    if form is Format.TABLE:
        rows = csv.DictReader(io.StringIO(body.decode(), newline=""))
        emit([_typed(row) for row in rows], tuple(rows.fieldnames or ()), form)
        return
    if form is Format.CSV:
        emit_csv(body.decode())
        return
    sys.stdout.flush()
    sys.stdout.buffer.write(body.rstrip(b"\n") + b"\n")
    sys.stdout.buffer.flush()


def _why(body: bytes) -> str:
    """Return what a problem document says."""
    try:
        document = json.loads(body)
    except ValueError:
        return "not an address of this interface"
    return str(document.get("detail") or document.get("title") or "refused")


def _typed(row: Mapping[str, str]) -> dict[str, str | float | int]:
    """Return cells that are numbers as numbers, so that they are aligned and rounded."""
    return {name: _number(text) for name, text in row.items()}


def _number(text: str) -> str | float | int:
    for kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            continue
    return text
