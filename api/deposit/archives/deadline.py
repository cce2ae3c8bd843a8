"""How long an answer may take in all: a server that sends a byte now and then is not waited for.

HTTP clients limit the time between two bytes. Here a timer runs from the last byte that is sent; at
its end the connection is shut down, and whoever reads from it gets an error.
"""

from __future__ import annotations

import socket
import threading
from contextlib import suppress
from types import TracebackType
from typing import Any


class Deadline:
    """A limit for one request after another on one connection: ``with`` it around each.

    Parameters
    ----------
    seconds : from the last byte sent to the last received

    Attributes
    ----------
    passed : whether the last request met its end
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.passed = False
        self._stream: Any = None
        self._timer: threading.Timer | None = None

    def __enter__(self) -> None:
        self.passed = False

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def watch(self, event: str, info: dict[str, Any]) -> None:
        """Take note of a step of a request (httpcore's trace extension)."""
        if event.endswith(("connect_tcp.complete", "start_tls.complete")):
            self._stream = info["return_value"]
        elif event.endswith("receive_response_headers.started") and self._timer is None:
            self._timer = threading.Timer(self.seconds, self._end)
            self._timer.daemon = True
            self._timer.start()

    def _end(self) -> None:
        self.passed = True
        held = self._stream.get_extra_info("socket") if self._stream is not None else None
        if held is not None:
            with suppress(OSError):
                # The one of the system: TLS would wait for the reader whom it is to wake.
                socket.socket.shutdown(held, socket.SHUT_RDWR)
