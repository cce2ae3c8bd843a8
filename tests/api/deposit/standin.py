"""A stand-in for InvenioRDM's records API, strict about the order of requests.

Written from docs-invenio-rdm (`reference/rest_api_drafts_records.md`) and the tests of zenodo-rdm.
"""

from __future__ import annotations

import hashlib
import json
import re
import threading
from contextlib import suppress
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

TOKEN = "tok-7f3a9c51d2e8"


class Refusal(Exception):  # noqa: N818 - an answer
    """An answer that is no success."""


class StandIn:
    """An archive in this process; `with` it is served at `address`.

    `fault(step, kind, times)` has so many requests of a step fail: with a status, "drop before"
    (nothing is done), "drop after" (the work is done, the answer is lost),
    "wrong checksum", or with bytes that are sent as they are.
    """

    def __init__(self) -> None:
        self.drafts: dict[str, dict[str, Any]] = {}
        self.records: dict[str, dict[str, Any]] = {}
        self.asked: list[tuple[str, str]] = []
        self.faults: dict[str, list[Any]] = {}
        self.signed: set[str | None] = set()
        #: Summed behind what is sent, so that a checksum is wrong.
        self.extra = b""

    def __enter__(self):
        handler = type("Handler", (_Handler,), {"stand_in": self})
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
        self._server.daemon_threads = True
        self.address = f"http://127.0.0.1:{self._server.server_address[1]}"
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.01,))
        self._thread.start()
        return self

    def __exit__(self, *_error):
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()

    def fault(self, step: str, kind: Any, times: int = 1) -> None:
        self.faults[step] = [kind] * times

    def files(self, name: str) -> dict[str, bytes]:
        """The whole files of a draft or record."""
        held = (self.drafts | self.records)[name]["files"]
        return {key: file["body"] for key, file in held.items() if file["status"] == "completed"}

    def sent(self) -> list[str]:
        return [path.split("/")[-2] for step, path in self.asked if step == "send"]

    def create(self, _name, _key, body):
        return 201, self._told(self._made(json.loads(body)["metadata"]))

    def record(self, name, *_):
        return 200, self._told(name, self.records)

    def version(self, name, *_):
        before = self.records[name]
        known = [n for n, draft in self.drafts.items() if draft["parent"] == name]
        return 201, self._told(known[0] if known else self._made(before["metadata"], name))

    def draft(self, name, *_):
        return 200, self._told(name)

    def describe(self, name, _key, body):
        document = json.loads(body)
        self.drafts[name] |= {part: document[part] for part in ("metadata", "pids")}
        return 200, self._told(name)

    def list(self, name, *_):
        files = self.drafts[name]["files"].values()
        return 200, {"enabled": True, "entries": [self._shown(file) for file in files]}

    def import_(self, name, *_):
        draft = self.drafts[name]
        self.require(not draft["files"], "Please remove all files first.")
        draft["files"] = {k: dict(f) for k, f in self.records[draft["parent"]]["files"].items()}
        return self.list(name)

    def declare(self, name, _key, body):
        for entry in json.loads(body):
            self.require(entry["key"] not in self.drafts[name]["files"], "File exists already.")
            self.drafts[name]["files"][entry["key"]] = {**entry, "status": "pending"}
        return self.list(name)

    def send(self, name, key, body):
        file = self.drafts[name]["files"][key]
        self.require(file["status"] == "pending", "File is committed.")
        file |= {"body": body, "checksum": f"md5:{hashlib.md5(body + self.extra).hexdigest()}"}
        return 200, self._shown(file)

    def commit(self, name, key, _body):
        file = self.drafts[name]["files"][key]
        self.require("body" in file and file["status"] == "pending", "No content to commit.")
        file["status"] = "completed"
        return 200, self._shown(file)

    def delete(self, name, key, _body):
        del self.drafts[name]["files"][key]
        return 204, None

    def publish(self, name, *_):
        draft = self.drafts[name]
        self.require(all(map(draft["metadata"].get, ("title", "creators", "publisher"))), "Title?")
        files = draft["files"].values()
        self.require(files and all(f["status"] == "completed" for f in files), "Files?")
        self.records[name] = self.drafts.pop(name)
        return 202, self._told(name, self.records)

    @staticmethod
    def _shown(file: dict[str, Any]) -> dict[str, Any]:
        return {name: value for name, value in file.items() if name != "body"}

    @staticmethod
    def require(holds: Any, otherwise: str) -> None:
        if not holds:
            raise Refusal(otherwise)

    def _made(self, metadata: dict[str, Any], parent: str | None = None) -> str:
        name = f"ab{len(self.drafts) + len(self.records):03d}-c0de"
        pids = {"doi": {"identifier": f"10.5072/zenodo.{name}", "provider": "datacite"}}
        self.drafts[name] = {"metadata": metadata, "files": {}, "pids": pids, "parent": parent}
        return name

    def _told(self, name: str, among: dict[str, Any] | None = None) -> dict[str, Any]:
        entry = (self.drafts if among is None else among)[name]
        shown = {"id": name, "is_published": among is not None, "a key of tomorrow": [1]}
        return {**shown, "metadata": entry["metadata"], "pids": entry["pids"]}


_ONE = r"/api/records/(?P<name>[^/]+)"
_FILES = rf"{_ONE}/draft/files"
_STEPS = {
    "create": ("POST", r"/api/records"),
    "record": ("GET", _ONE),
    "version": ("POST", rf"{_ONE}/versions"),
    "draft": ("GET", rf"{_ONE}/draft"),
    "describe": ("PUT", rf"{_ONE}/draft"),
    "import": ("POST", rf"{_ONE}/draft/actions/files-import"),
    "publish": ("POST", rf"{_ONE}/draft/actions/publish"),
    "list": ("GET", _FILES),
    "declare": ("POST", _FILES),
    "delete": ("DELETE", rf"{_FILES}/(?P<key>[^/]+)"),
    "send": ("PUT", rf"{_FILES}/(?P<key>[^/]+)/content"),
    "commit": ("POST", rf"{_FILES}/(?P<key>[^/]+)/commit"),
}


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # or each answer would wait for an acknowledgement
    stand_in: StandIn

    def log_message(self, *_arguments):
        pass

    def _handle(self):
        found = {
            step: match.groupdict()
            for step, (method, pattern) in _STEPS.items()
            if method == self.command and (match := re.fullmatch(pattern, self.path))
        }
        ((step, names),) = found.items()
        body = self.rfile.read(int(self.headers.get("Content-Length") or 0))
        self.stand_in.asked.append((step, self.path))
        self.stand_in.signed.add(self.headers.get("Authorization"))
        faults = self.stand_in.faults.get(step)
        kind = faults.pop(0) if faults else None
        if isinstance(kind, bytes) or kind == "drop before":
            self._break(kind)
            return
        if isinstance(kind, int):
            echo = f"you sent {self.headers.get('Authorization')}"
            self._say(kind, {"message": echo}, {"Retry-After": "7", "Location": "http://a.example"})
            return
        try:
            self.stand_in.extra = b"!" * (kind == "wrong checksum")
            act = getattr(self.stand_in, step.replace("import", "import_"))
            said = act(names.get("name", ""), names.get("key", ""), body)
        except KeyError as error:
            said = 404, {"message": f"no {error}"}
        except Refusal as error:
            said = 400, {"message": str(error)}
        if kind == "drop after":
            self.close_connection = True
            return
        self._say(*said)

    def _break(self, kind: Any) -> None:
        self.close_connection = True
        with suppress(OSError):  # the client may have had enough of it
            if isinstance(kind, bytes):
                self.connection.sendall(kind)

    def _say(self, status: int, document: Any, headers: dict[str, str] | None = None):
        said = b"" if status == 204 else json.dumps(document).encode()
        self.send_response(status)
        sent = {"Content-Type": "application/json", "Content-Length": str(len(said))}
        for name, value in ({**sent, **(headers or {})} if status != 204 else {}).items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(said)

    do_GET = do_POST = do_PUT = do_DELETE = _handle  # noqa: N815 - http.server's names
