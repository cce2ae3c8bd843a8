"""A service that another one can take the place of while it runs."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from types import FrameType

from starlette.types import ASGIApp, Receive, Scope, Send

from benchmark.processes import for_coordinator


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
def renewed_after(
    command: Sequence[str], service: Renewed, renew: Callable[[], ASGIApp]
) -> Iterator[threading.Thread]:
    """Run a command beside the service, and renew the service when it has ended well.

    The command ends with the context. What it prints is dropped, errors excepted.

    Parameters
    ----------
    command : to run
    service : to renew
    renew : makes the application that takes over

    Yields
    ------
    threading.Thread
        That waits for the command.
    """
    with beside(command) as process:

        def wait() -> None:
            if process.wait() == 0:
                service.app = renew()

        waiting = threading.Thread(target=wait, name="renewal", daemon=True)
        waiting.start()
        try:
            yield waiting
        finally:
            process.terminate()
            waiting.join()


@contextlib.contextmanager
def beside(command: Sequence[str]) -> Iterator[subprocess.Popen[bytes]]:
    """Run a command beside the service; it ends with the context.

    What it prints is dropped, errors excepted.

    Parameters
    ----------
    command : to run

    Yields
    ------
    subprocess.Popen
        Which runs it.
    """
    process = subprocess.Popen(  # noqa: S603 - the caller's own program
        command,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        env={**os.environ, **for_coordinator()},
    )
    try:
        with _ended_by_exception():
            yield process
    finally:
        process.terminate()
        process.wait()


@contextlib.contextmanager
def _ended_by_exception() -> Iterator[None]:
    """Let a request to terminate unwind what is open; by itself it would leave the command behind.

    Servers that shut down at the signal raise it again when they are done.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # signals are the main thread's
        return

    def end(number: int, _: FrameType | None) -> None:
        raise SystemExit(128 + number)

    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
