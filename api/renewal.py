"""A service that another one can take the place of while it runs."""

from __future__ import annotations

import contextlib
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

from starlette.types import ASGIApp, Receive, Scope, Send


class Renewed:
    """An ASGI application that hands every request to the newest of others.

    Start-up and shutdown are those of the first.

    Parameters
    ----------
    app : the first
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer as the newest application does."""
        await self.app(scope, receive, send)


@contextlib.contextmanager
def renewed_with_times(
    service: Renewed, directory: Path, renew: Callable[[], ASGIApp]
) -> Iterator[None]:
    """Time every pipeline in a process beside, and renew the service when that is done.

    The process ends with the context.

    Parameters
    ----------
    service : to renew
    directory : where times are kept
    renew : makes the application that knows the times
    """
    call = [sys.executable, "-m", "api.command_line", "leaderboard", "times"]
    process = subprocess.Popen(  # noqa: S603 - this program, and a directory the user named
        [*call, "--store", str(directory), "--format", "json"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
    )

    def wait() -> None:
        if process.wait() == 0:
            service.app = renew()

    waiting = threading.Thread(target=wait, name="times", daemon=True)
    waiting.start()
    try:
        yield
    finally:
        process.terminate()
        waiting.join()
