"""`sunatlas serve`: the page and the HTTP interface on a port of this machine."""

from __future__ import annotations

import contextlib
import socket
import sys
from functools import partial
from typing import Annotated

import typer
import uvicorn
from fastapi import FastAPI

from api.cli.working import working_directory
from api.http.knowledge import Knowledge
from api.http.measurements import Measurements
from api.http.renewal import Renewed, renewed_after
from api.http.service import create_app

app = typer.Typer(add_completion=False, rich_markup_mode=None)

_TIMES = (sys.executable, "-m", "api.cli.command_line", "leaderboard", "times", "--format", "json")


@app.command()
def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen on; 0 takes a free one.")
    ] = 8000,
    times: Annotated[
        bool,
        typer.Option(
            "--times",
            help="Time every pipeline on this machine meanwhile, where that is not done yet, and "
            "serve the times as soon as they are there.",
        ),
    ] = False,
) -> None:
    """Serve the page and the HTTP interface.

    The page is at /, the API under /v1, its description at /openapi.json. Ctrl-C stops.
    """
    listener = listen(host, port)
    with listener, contextlib.ExitStack() as stack:
        application = Renewed(_application())
        config = uvicorn.Config(application, log_level="warning")
        if times:
            renew = partial(_application, loaded=True)
            stack.enter_context(renewed_after(_TIMES, application, renew))
        typer.echo(f"Sun Sensor Atlas: {address(host, listener.getsockname()[1])} (Ctrl-C stops)")
        uvicorn.Server(config).run(sockets=[listener])


def _application(*, loaded: bool = False) -> FastAPI:
    """Make the service with what is known now, times of this machine included."""
    known = Knowledge(Measurements(times_directory=working_directory()))
    if loaded:
        known.load_all()
    return create_app(known)


def listen(host: str, port: int) -> socket.socket:
    """Open a listening socket, so that the port is known to be ours before anything is loaded.

    Raises
    ------
    OSError
        Where the address is unknown or the port is taken or not allowed; the message says which.
    """
    try:
        family, kind, protocol, _, place = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
    except socket.gaierror as error:
        raise OSError(
            f"no address named {host!r} ({error.strerror}); try --host 127.0.0.1"
        ) from error
    listener = socket.socket(family, kind, protocol)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(place)
        listener.listen(socket.SOMAXCONN)
    except OSError as error:
        listener.close()
        raise OSError(
            f"cannot listen on {host} port {port}: {error.strerror}; choose another with --port"
        ) from error
    return listener


def address(host: str, port: int) -> str:
    """Return the URL to open in a browser of this machine."""
    name = {"0.0.0.0": "127.0.0.1", "::": "::1", "": "127.0.0.1"}.get(host, host)  # noqa: S104 - read, not bound
    return f"http://[{name}]:{port}" if ":" in name else f"http://{name}:{port}"
