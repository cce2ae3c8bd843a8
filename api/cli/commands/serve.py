"""`sunatlas serve`: the page and the HTTP interface on a port of this machine."""

from __future__ import annotations

import contextlib
import copy
import gc
import os
import socket
import sys
from typing import Annotated, Any

import typer
import uvicorn
from uvicorn.config import LOGGING_CONFIG
from uvicorn.supervisors import Multiprocess

from api.server import serving
from api.server.prefix import PREFIX
from api.service import calibrations
from benchmark.processes import take_time_to_end
from files.atomic import sweep, temporary_directory

#: Of Uvicorn, with bounds for each client; a proxy knows them better (deploy/Caddyfile).
_OPTIONS: dict[str, Any] = {
    "ws": "none",
    "proxy_headers": False,  # the application reads them (api/server/prefix.py)
    "http": "api.server.connections:BoundedProtocol",
    "limit_concurrency": 1000,
    "timeout_graceful_shutdown": 5,
}
#: Uvicorn's own, which says nothing of starts and stops.
_LOG: dict[str, Any] = copy.deepcopy(LOGGING_CONFIG)
_LOG["loggers"]["uvicorn.error"]["level"] = "WARNING"
#: Descriptor of the socket that systemd hands over.
_FIRST_HANDED = 3
#: How long workers may take to end, one after another, on a busy machine, s: usually 1.5.
_WORKERS_END_S = 15.0


def serve(
    host: Annotated[str, typer.Option(help="Address to listen on.")] = "127.0.0.1",
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port to listen on; 0 selects a free port.")
    ] = 8000,
    workers: Annotated[
        int, typer.Option(min=1, max=64, help="Number of processes, each with all data loaded.")
    ] = 1,
    access_log: Annotated[
        bool, typer.Option("--access-log", help="Print a line per request.")
    ] = False,
    root_path: Annotated[
        str, typer.Option(help="Prefix that a proxy in front removes, such as /atlas.")
    ] = "",
) -> None:
    """Serve the web pages, the guide and the HTTP API.

    Pages are at /, the guide at /guide, the API at /v1, its reference at /docs, its OpenAPI
    description at /openapi.json, Prometheus metrics at /metrics. The guide must be built first
    (`sunatlas guide build`). Stop with Ctrl-C. With several workers, SIGHUP replaces them one after
    another. A socket that systemd hands over is served instead of --host and --port.

    Behind a proxy that serves it under a prefix, --root-path says which, or the proxy does by
    X-Forwarded-Prefix, if FORWARDED_ALLOW_IPS (by default 127.0.0.1) has its address.
    """
    root_path = root_path.rstrip("/")
    if root_path and not PREFIX.fullmatch(root_path):
        raise typer.BadParameter(f"expected a path such as /atlas; got {root_path}")
    options = {**_OPTIONS, "root_path": root_path, "access_log": access_log}
    listener = inherited() or listen(host, port)
    with listener, contextlib.ExitStack() as stack:
        # Loaded before anything is served: damaged facts are refused in one sentence.
        application = serving.application(loaded=True)
        host, port = listener.getsockname()[:2]
        typer.echo(f"Sun Sensor Atlas: {address(host, port)} (Ctrl-C stops)")
        sys.stdout.flush()  # who reads a pipe waits for the address
        # Python walks all that was loaded before it ends, for a second or two, unless it is frozen.
        stack.callback(gc.freeze)
        sweep()
        shared = str(stack.enter_context(temporary_directory()))
        os.environ[calibrations.SHARED] = shared
        if workers > 1:
            os.environ["PROMETHEUS_MULTIPROC_DIR"] = shared
            take_time_to_end(_WORKERS_END_S)
            _serve_by_many(listener, workers, options)
            return
        config = uvicorn.Config(application, log_config=_LOG, **options)
        uvicorn.Server(config).run(sockets=[listener])


def _serve_by_many(listener: socket.socket, workers: int, options: dict[str, Any]) -> None:
    """Serve by several processes that share a listening socket, until a signal ends them."""
    config = uvicorn.Config(
        "api.server.serving:application_of_worker",
        factory=True,
        workers=workers,
        timeout_worker_healthcheck=60,  # loading takes seconds, and more on a busy machine
        log_config=_LOG,
        **options,
    )
    Multiprocess(config, [listener]).run()


def inherited() -> socket.socket | None:
    """Return the listening socket that systemd hands over (sd_listen_fds), if it does."""
    if os.environ.get("LISTEN_PID") != str(os.getpid()) or os.environ.get("LISTEN_FDS") != "1":
        return None
    for name in ("LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES"):  # not for workers
        os.environ.pop(name, None)
    os.set_inheritable(_FIRST_HANDED, False)
    return socket.socket(fileno=_FIRST_HANDED)


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
