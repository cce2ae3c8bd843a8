"""A stand-in for Zenodo's legacy deposit interface, strict about the order of requests.

Written from developers.zenodo.org and zenodo-rdm's `site/tests/legacy`.
"""

from __future__ import annotations

import hashlib
import json
import re
from typing import Any

from tests.api.deposit.standins.server import Refusal, StandIn

_METADATA = {
    *("title", "upload_type", "description", "creators", "access_right", "license", "version"),
    *("publication_date", "keywords", "language", "related_identifiers", "prereserve_doi"),
}
_REQUIRED = ("title", "upload_type", "description", "creators")


class Depositions(StandIn):
    """Depositions by id; `submitted` ones are the published."""

    def __init__(self) -> None:
        super().__init__()
        self.all: dict[str, dict[str, Any]] = {}
        self.bucket_at: str | None = None
        #: Whether new versions start without the files of the one before, as they should not.
        self.refuses_versions = False
        self._made = 0

    @property
    def drafts(self) -> dict[str, Any]:
        return {name: entry for name, entry in self.all.items() if not entry["submitted"]}

    @property
    def records(self) -> dict[str, Any]:
        return {name: entry for name, entry in self.all.items() if entry["submitted"]}

    def held(self, identifier: str) -> dict[str, bytes]:
        """The files of a deposition."""
        return {key: file["body"] for key, file in self.all[identifier]["files"].items()}

    def answer(self, method: str, path: str, kind: str, body: bytes) -> tuple[int, Any]:
        one = r"/api/deposit/depositions/(\d+)"
        bucket = re.fullmatch(r"/api/files/bucket-(\d+)/([^/]+)", path)
        if bucket and method == "PUT":
            if kind != "application/octet-stream":
                raise Refusal(415, f"unsupported media type {kind}")
            return self._put(*bucket.groups(), body)
        routes = (
            ("POST", r"/api/deposit/depositions", self._create),
            ("GET", one, self._look),
            ("PUT", one, self._describe),
            ("GET", f"{one}/files", self._list),
            ("DELETE", f"{one}/files/([^/]+)", self._delete),
            ("POST", f"{one}/actions/publish", self._publish),
            ("POST", f"{one}/actions/newversion", self._version),
        )
        for wanted, pattern, act in routes:
            found = re.fullmatch(pattern, path)
            if found and wanted == method:
                if body and kind != "application/json":
                    raise Refusal(415, f"unsupported media type {kind}")
                return act(*found.groups(), *([json.loads(body)] if body else []))
        raise Refusal(405, f"{method} {path} is in no documentation")

    def _make(self, metadata: dict[str, Any]) -> str:
        self._made += 1
        name = str(1000 + self._made)
        self.all[name] = {"metadata": metadata, "files": {}, "submitted": False, "latest": name}
        return name

    def _told(self, name: str) -> dict[str, Any]:
        entry = self.all[name]
        at = f"{self.address}/api/deposit/depositions"
        return {
            "id": int(name),
            "record_id": int(name),
            "conceptrecid": str(int(name) - 1),
            "state": "done" if entry["submitted"] else "unsubmitted",
            "submitted": entry["submitted"],
            "title": entry["metadata"].get("title", ""),
            **({"doi": f"10.5072/zenodo.{name}"} if entry["submitted"] else {}),
            "metadata": {
                **entry["metadata"],
                "prereserve_doi": {"doi": f"10.5072/zenodo.{name}", "recid": int(name)},
            },
            "files": self._files(entry),
            "links": {
                "self": f"{at}/{name}",
                "bucket": f"{self.bucket_at or self.address}/api/files/bucket-{name}",
                "latest_draft": f"{at}/{entry['latest']}",
            },
            "a key of tomorrow": None,
        }

    @staticmethod
    def _files(entry: dict[str, Any]) -> list[dict[str, Any]]:
        return [
            {"id": f["id"], "filename": key, "filesize": len(f["body"]), "checksum": f["md5"]}
            for key, f in entry["files"].items()
        ]

    def _checked(self, document: dict[str, Any]) -> dict[str, Any]:
        if set(document) - {"metadata"}:
            raise Refusal(400, f"unknown {sorted(set(document) - {'metadata'})}")
        metadata = document.get("metadata", {})
        if set(metadata) - _METADATA:
            raise Refusal(400, f"unknown {sorted(set(metadata) - _METADATA)}")
        return metadata

    def _create(self, document: dict[str, Any]) -> tuple[int, Any]:
        return 201, self._told(self._make(self._checked(document)))

    def _one(self, name: str) -> dict[str, Any]:
        if name not in self.all:
            raise Refusal(404, "The persistent identifier does not exist.")
        return self.all[name]

    def _open(self, name: str) -> dict[str, Any]:
        entry = self._one(name)
        if entry["submitted"]:
            raise Refusal(403, "Deposition is published.")
        return entry

    def _look(self, name: str) -> tuple[int, Any]:
        self._one(name)
        return 200, self._told(name)

    def _describe(self, name: str, document: dict[str, Any]) -> tuple[int, Any]:
        self._open(name)["metadata"] = self._checked(document)
        return 200, self._told(name)

    def _list(self, name: str) -> tuple[int, Any]:
        return 200, self._files(self._one(name))

    def _put(self, name: str, key: str, body: bytes) -> tuple[int, Any]:
        files = self._open(name)["files"]
        digest = hashlib.md5(body + b"!" * self.wrong_checksum).hexdigest()
        files[key] = {"body": body, "md5": digest, "id": f"f-{name}-{len(files)}"}
        return 201, {
            "key": key,
            "mimetype": "application/octet-stream",
            "checksum": f"md5:{digest}",
            "size": len(body),
            "is_head": True,
            "delete_marker": False,
        }

    def _delete(self, name: str, identifier: str) -> tuple[int, Any]:
        files = self._open(name)["files"]
        for key, file in files.items():
            if file["id"] == identifier:
                del files[key]
                return 204, None
        raise Refusal(404, "no such file")

    def _publish(self, name: str) -> tuple[int, Any]:
        entry = self._one(name)
        if entry["submitted"]:
            raise Refusal(404, "Deposition is published already.")
        missing = [key for key in _REQUIRED if not entry["metadata"].get(key)]
        if missing:
            raise Refusal(
                400,
                "Validation error.",
                errors=[{"field": f"metadata.{missing[0]}", "message": "Missing data."}],
            )
        if not entry["files"]:
            raise Refusal(400, "Minimum one file must be provided.")
        entry["submitted"] = True
        return 202, self._told(name)

    def _version(self, name: str) -> tuple[int, Any]:
        entry = self._one(name)
        if not entry["submitted"]:
            raise Refusal(403, "Deposition is not published.")
        if self.refuses_versions or not self.all[entry["latest"]]["submitted"]:
            raise Refusal(
                400,
                "A validation error occurred.",
                errors=[{"field": "files.enabled", "messages": ["Please remove all files first."]}],
            )
        metadata = {k: v for k, v in entry["metadata"].items() if k != "publication_date"}
        made = self._make(metadata)
        self.all[made]["files"] = {
            key: {**file, "id": f"f-{made}-{n}"}
            for n, (key, file) in enumerate(entry["files"].items())
        }
        entry["latest"] = made
        # As documented: the answer is the published record, the draft is where latest_draft points.
        return 201, self._told(name)
