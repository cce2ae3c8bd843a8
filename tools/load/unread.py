"""Clients that ask and never read, beside those that do."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, field

ASKED = b"GET /v1/results?limit=500 HTTP/1.1\r\nHost: atlas\r\n\r\n" * 100


@dataclass
class Unread:
    """Sockets that read nothing.

    Attributes
    ----------
    opened : how many there were
    closed_s : seconds after which each of those that were closed was, as it was noticed
    """

    opened: int
    closed_s: list[float] = field(default_factory=list)


@contextlib.contextmanager
def unread(place: tuple[str, int], sockets: int) -> Iterator[Unread]:
    """Open sockets that pipeline requests and read nothing; yield what becomes of them."""
    found = Unread(sockets)
    over = threading.Event()

    def look(plugs: list[socket.socket]) -> None:
        start = time.monotonic()
        while plugs and not over.wait(0.25):
            for plug in tuple(plugs):
                try:
                    plug.send(b"G")  # refused where the other side has let go
                except BlockingIOError:
                    pass
                except OSError:
                    found.closed_s.append(time.monotonic() - start)
                    plugs.remove(plug)

    with contextlib.ExitStack() as stack:
        plugs = []
        for _ in range(sockets):
            plug = stack.enter_context(socket.create_connection(place, timeout=60))
            plug.setblocking(False)
            plug.send(ASKED)
            plugs.append(plug)
        looking = threading.Thread(target=look, args=(plugs,), daemon=True)
        looking.start()
        try:
            yield found
        finally:
            over.set()
            looking.join()
