"""What both stand-ins of an archive share: a thread with a server, faults, what was asked.

A stand-in is an oracle: it answers as the archive documents it and refuses whatever comes out of
order. Every request is noted before it is answered.
"""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from tests.api.deposit.standins.replies import Reply

TOKEN = "tok-7f3a9c51d2e8"


class Refusal(Exception):  # noqa: N818 - an answer
    """An answer that is no success."""

    def __init__(self, status: int, message: str, **members: Any) -> None:
        super().__init__(message)
        self.status = status
        self.document = {"status": status, "message": message, **members}


@dataclass
class Fault:
    """What happens instead of, or to, the answers to requests that `at` holds for.

    Attributes
    ----------
    kind : a status, "drop before" or "drop after" (the work is done, the answer is lost), "wrong
        checksum", "redirect", "hold" (the answer waits until `released`), or a `replies.Reply`
    at : method and path of a request -> whether it is met
    times : how often
    headers : of the answer
    """

    kind: int | str | Reply
    at: Callable[[str, str], bool]
    times: int = 1
    headers: Mapping[str, str] = field(default_factory=dict)
    met: threading.Event = field(default_factory=threading.Event)
    released: threading.Event = field(default_factory=threading.Event)


@dataclass(frozen=True)
class Asked:
    """A request as it came."""

    method: str
    path: str
    headers: Mapping[str, str]


class StandIn:
    """An archive in this process; `with` it is served at `address`.

    Subclasses answer: `answer(method, path, content_type, body) -> (status, document)`, where a
    `Refusal` is an answer too.
    """

    def __init__(self) -> None:
        self.asked: list[Asked] = []
        self.faults: list[Fault] = []
        self.lock = threading.RLock()
        #: Set by answers whose checksum is to be sent wrong.
        self.wrong_checksum = False

    def answer(self, method: str, path: str, kind: str, body: bytes) -> tuple[int, Any]:
        raise NotImplementedError

    def __enter__(self):
        handler = type("Handler", (_Handler,), {"stand_in": self})
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self._server.daemon_threads = True
        self.address = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self._thread.start()
        return self

    def __exit__(self, *_error):
        for fault in self.faults:
            fault.released.set()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def fault(self, method: str, path: str) -> Fault | None:
        for fault in self.faults:
            if fault.times and fault.at(method, path):
                fault.times -= 1
                return fault
        return None

    def calls(self, method: str, ending: str = "") -> list[str]:
        return [a.path for a in self.asked if a.method == method and a.path.endswith(ending)]


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # or each answer would wait for an acknowledgement
    stand_in: StandIn

    def log_message(self, *_arguments):
        pass

    def _handle(self):
        archive = self.stand_in
        path = self.path.partition("?")[0]
        with archive.lock:
            archive.asked.append(Asked(self.command, path, dict(self.headers)))
            fault = archive.fault(self.command, path)
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        kind = fault.kind if fault else None
        if fault:
            fault.met.set()
        if kind == "hold":
            fault.released.wait(60)
            self.close_connection = True
            return
        if kind == "drop before":
            self._drop()
            return
        if isinstance(kind, bytes) or callable(kind):
            self._answer_raw(kind)
            return
        if kind == "redirect":
            self._say(302, {}, fault.headers)
            return
        if isinstance(kind, int):
            self._say(kind, {"status": kind, "message": f"as sent, {self._echo()}"}, fault.headers)
            return
        with archive.lock:
            archive.wrong_checksum = kind == "wrong checksum"
            try:
                self._require_signed()
                found = archive.answer(
                    self.command, path, self.headers.get("Content-Type", ""), body
                )
            except Refusal as refusal:
                found = refusal.status, refusal.document
        if kind == "drop after":
            self._drop()
            return
        self._say(*found)

    def _echo(self) -> str:
        """A server that says the token back, as some do in the message of a refusal."""
        return f"you sent {self.headers.get('Authorization')}"

    def _require_signed(self):
        if self.headers.get("Authorization") != f"Bearer {TOKEN}":
            raise Refusal(401, "The server could not verify that you are authorized.")
        agent = self.headers.get("User-Agent", "")
        if not agent.startswith("sun-sensor-atlas/"):
            raise Refusal(403, f"name yourself, {agent}")

    def _drop(self):
        self.connection.shutdown(socket.SHUT_RDWR)
        self.close_connection = True

    def _answer_raw(self, reply: Reply):
        self.close_connection = True
        with suppress(OSError):  # the client may have had enough of it
            self.connection.settimeout(20)
            if callable(reply):
                reply(self.connection.sendall)
            else:
                self.connection.sendall(reply)

    def _say(self, status: int, document: Any, headers: Mapping[str, str] | None = None):
        said = b"" if status == 204 else json.dumps(document).encode()
        self.send_response(status)
        for name, value in (headers or {}).items():
            self.send_header(name, value)
        if status != 204:
            self.send_header("Content-Type", "application/json")
            self.send_header("Content-Length", str(len(said)))
        self.end_headers()
        self.wfile.write(said)

    do_GET = do_POST = do_PUT = do_DELETE = _handle  # noqa: N815 - http.server's names
