"""A stand-in for InvenioRDM's records interface, strict about the order of requests.

Written from docs-invenio-rdm (`reference/rest_api_drafts_records.md`) and the tests of zenodo-rdm.
"""

from __future__ import annotations

import hashlib
import json
import re
from typing import Any

from tests.api.deposit.standins.server import Refusal, StandIn

_REQUIRED = ("resource_type", "title", "publication_date", "creators")


class Records(StandIn):
    """Records and drafts by id: a dictionary each, with files, metadata, pids."""

    def __init__(self) -> None:
        super().__init__()
        self.drafts: dict[str, dict[str, Any]] = {}
        self.records: dict[str, dict[str, Any]] = {}
        self._made = 0

    def held(self, identifier: str) -> dict[str, bytes]:
        """The whole files of a draft or record."""
        entry = self.drafts.get(identifier) or self.records[identifier]
        return {k: f["body"] for k, f in entry["files"].items() if f["status"] == "completed"}

    def answer(self, method: str, path: str, kind: str, body: bytes) -> tuple[int, Any]:
        routes = (
            ("POST", r"/api/records", self._create),
            ("GET", r"/api/records/([^/]+)", self._record),
            ("POST", r"/api/records/([^/]+)/versions", self._version),
            ("GET", r"/api/records/([^/]+)/draft", self._look),
            ("PUT", r"/api/records/([^/]+)/draft", self._describe),
            ("POST", r"/api/records/([^/]+)/draft/actions/files-import", self._import),
            ("POST", r"/api/records/([^/]+)/draft/actions/publish", self._publish),
            ("GET", r"/api/records/([^/]+)/draft/files", self._list),
            ("POST", r"/api/records/([^/]+)/draft/files", self._declare),
            ("GET", r"/api/records/([^/]+)/draft/files/([^/]+)", self._entry),
            ("DELETE", r"/api/records/([^/]+)/draft/files/([^/]+)", self._delete),
            ("PUT", r"/api/records/([^/]+)/draft/files/([^/]+)/content", self._content),
            ("POST", r"/api/records/([^/]+)/draft/files/([^/]+)/commit", self._commit),
        )
        for wanted, pattern, act in routes:
            found = re.fullmatch(pattern, path)
            if found and wanted == method:
                if method == "PUT" and path.endswith("/content"):
                    if kind != "application/octet-stream":
                        raise Refusal(415, f"unsupported media type {kind}")
                    return act(*found.groups(), body)
                if body and kind != "application/json":
                    raise Refusal(415, f"unsupported media type {kind}")
                return act(*found.groups(), *([json.loads(body)] if body else []))
        raise Refusal(405, f"{method} {path} is in no documentation")

    def _make(self, metadata: dict[str, Any], index: int, parent: str | None) -> str:
        self._made += 1
        name = f"ab{self._made:03d}-c0de"
        self.drafts[name] = {
            "metadata": metadata,
            "files": {},
            "pids": {"doi": {"identifier": f"10.5072/zenodo.{name}", "provider": "datacite"}},
            "index": index,
            "parent": parent,
        }
        return name

    def _told(self, name: str, *, published: bool = False) -> dict[str, Any]:
        entry = (self.records if published else self.drafts)[name]
        return {
            "id": name,
            "is_published": published,
            "is_draft": not published,
            "metadata": entry["metadata"],
            "pids": entry["pids"],
            "versions": {"index": entry["index"], "is_latest": published},
            "links": {"self": f"{self.address}/api/records/{name}"},
            "a key of tomorrow": [1, 2],
        }

    def _create(self, document: dict[str, Any]) -> tuple[int, Any]:
        if document.get("files") != {"enabled": True}:
            raise Refusal(400, "files.enabled")
        return 201, self._told(self._make(document["metadata"], 1, None))

    def _draft(self, name: str) -> dict[str, Any]:
        if name not in self.drafts:
            raise Refusal(404, "The persistent identifier does not exist.")
        return self.drafts[name]

    def _record(self, name: str) -> tuple[int, Any]:
        if name not in self.records:
            raise Refusal(404, "The persistent identifier is registered but not published.")
        return 200, self._told(name, published=True)

    def _version(self, name: str) -> tuple[int, Any]:
        if name not in self.records:
            raise Refusal(404, "The persistent identifier does not exist.")
        for known, draft in self.drafts.items():
            if draft["parent"] == name:
                return 201, self._told(known)
        before = self.records[name]
        kept = {
            key: value
            for key, value in before["metadata"].items()
            if key not in {"publication_date", "version"}
        }
        return 201, self._told(self._make(kept, before["index"] + 1, name))

    def _look(self, name: str) -> tuple[int, Any]:
        self._draft(name)
        return 200, self._told(name)

    def _describe(self, name: str, document: dict[str, Any]) -> tuple[int, Any]:
        draft = self._draft(name)
        draft["metadata"], draft["pids"] = document["metadata"], document.get("pids", {})
        return 200, self._told(name)

    def _import(self, name: str) -> tuple[int, Any]:
        draft = self._draft(name)
        if draft["parent"] is None:
            raise Refusal(400, "there is no version before")
        if draft["files"]:
            raise Refusal(400, "Please remove all files first.")
        draft["files"] = {k: dict(f) for k, f in self.records[draft["parent"]]["files"].items()}
        return 201, {"enabled": True, "entries": self._entries(draft)}

    def _entries(self, draft: dict[str, Any]) -> list[dict[str, Any]]:
        return [
            {
                "key": key,
                "status": file["status"],
                **(
                    {"checksum": f"md5:{file['md5']}", "size": len(file["body"])}
                    if file["status"] == "completed"
                    else {}
                ),
            }
            for key, file in draft["files"].items()
        ]

    def _list(self, name: str) -> tuple[int, Any]:
        return 200, {"enabled": True, "entries": self._entries(self._draft(name))}

    def _file(self, name: str, key: str) -> dict[str, Any]:
        files = self._draft(name)["files"]
        if key not in files:
            raise Refusal(404, f"No file {key}")
        return files[key]

    def _entry(self, name: str, key: str) -> tuple[int, Any]:
        self._file(name, key)
        return 200, next(e for e in self._entries(self._draft(name)) if e["key"] == key)

    def _declare(self, name: str, keys: list[dict[str, str]]) -> tuple[int, Any]:
        draft = self._draft(name)
        for entry in keys:
            if entry["key"] in draft["files"]:
                raise Refusal(400, f"File with key {entry['key']} already exists.")
            draft["files"][entry["key"]] = {"status": "pending", "body": None, "md5": None}
        return 201, {"enabled": True, "entries": self._entries(draft)}

    def _content(self, name: str, key: str, body: bytes) -> tuple[int, Any]:
        file = self._file(name, key)
        if file["status"] != "pending":
            raise Refusal(400, f"File {key} is committed.")
        file["body"] = body
        file["md5"] = hashlib.md5(body + b"!" * self.wrong_checksum).hexdigest()
        return 200, {"key": key, "status": "pending"}

    def _commit(self, name: str, key: str) -> tuple[int, Any]:
        file = self._file(name, key)
        if file["status"] != "pending" or file["body"] is None:
            raise Refusal(400, f"File {key} has no content to commit.")
        file["status"] = "completed"
        return self._entry(name, key)

    def _delete(self, name: str, key: str) -> tuple[int, Any]:
        self._file(name, key)
        del self._draft(name)["files"][key]
        return 204, None

    def _publish(self, name: str) -> tuple[int, Any]:
        draft = self._draft(name)
        missing = [key for key in _REQUIRED if not draft["metadata"].get(key)]
        if missing:
            raise Refusal(
                400,
                "A validation error occurred.",
                errors=[{"field": f"metadata.{missing[0]}", "messages": ["Missing data."]}],
            )
        if not draft["metadata"].get("publisher"):
            raise Refusal(400, "Missing publisher field required for DOI registration.")
        if not draft["files"] or any(f["status"] != "completed" for f in draft["files"].values()):
            raise Refusal(400, "Missing or pending uploaded files.")
        self.records[name] = self.drafts.pop(name)
        return 202, self._told(name, published=True)
