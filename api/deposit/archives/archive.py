"""A client of InvenioRDM's records API, which Zenodo runs.

Sequence (docs-invenio-rdm, `reference/rest_api_drafts_records.md`): make a draft; for each file
declare, send, commit; describe; publish. Each method looks at what is there first, so that it can
be tried again after a failure that leaves open whether a request arrived. The token goes to one
server: no address from an answer is asked, and no redirect is followed.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, ParamSpec, TypeVar
from urllib.parse import quote

import httpx
import tenacity
from pydantic import BaseModel, ConfigDict, Field, SecretStr, StringConstraints, ValidationError

from api.deposit.archives.server import ArchiveError, Server
from api.metadata.identity import version

#: How often a request is tried, and the longest pause that a server may ask for, in seconds.
TRIES, PATIENCE = 6, 900.0
#: Bytes of an answer, and pieces in which it comes: a thousand files take a tenth of it.
_LARGEST, _MOST_PIECES = 4_000_000, 20_000
_ALL = "/api/records"
_IDENTIFIER = r"^[A-Za-z0-9][A-Za-z0-9-]{0,63}$"
#: Without what a terminal would act on, and letters that turn the direction of reading.
_LINE = r"^[^\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]{0,1000}$"
_ADVICE = {
    302: "redirects are not followed, so that nobody else is sent the token",
    401: "the token is not valid here; {variable} has to hold one made at {address}",
    403: "the token lacks a scope (deposit:write, deposit:actions), or the record is not yours",
    409: "the record is being changed elsewhere, or is locked; wait, then run the command again",
    413: "the file is larger than the archive takes",
    429: "the archive limits how often it is asked; wait some minutes, then run the command again",
    503: "the archive is out of service for the moment; run the command again later",
}
Line = Annotated[str, StringConstraints(pattern=_LINE)]
R = TypeVar("R", bound="Reply")
T = TypeVar("T")
P = ParamSpec("P")


class RefusedError(ArchiveError):
    """The archive answered that it will not; `status` is that of HTTP."""

    def __init__(self, message: str, status: int) -> None:
        super().__init__(message)
        self.status = status


class MomentaryError(ArchiveError):
    """A failure that may pass; `pause` is what the archive asks to wait, in seconds, or None."""

    def __init__(self, message: str, pause: float | None = None) -> None:
        super().__init__(message)
        self.pause = pause


class Reply(BaseModel):
    """An answer; further members may be there, wrong ones are named."""

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore")


class _Pid(Reply):
    identifier: Line
    scheme: Line | None = None
    provider: Line | None = None
    client: Line | None = None


class _Who(Reply):
    name: Line | None = None
    family_name: Line | None = None
    given_name: Line | None = None
    identifiers: list[_Pid] | None = None


class _Creator(Reply):
    person_or_org: _Who


class Metadata(Reply):
    """Metadata of a record, of which only the authors are looked at."""

    creators: list[_Creator] | None = None

    @property
    def authors(self) -> list[str]:
        """Names and ORCID iDs."""
        found = []
        for who in (creator.person_or_org for creator in self.creators or ()):
            named = [who.family_name, who.given_name] if who.family_name else [who.name]
            orcids = [one.identifier for one in who.identifiers or () if one.scheme == "orcid"]
            found.append(", ".join(part for part in (*named, *orcids) if part))
        return found


class Record(Reply):
    """A record or draft."""

    id: Annotated[str, StringConstraints(pattern=_IDENTIFIER)]
    is_published: bool | None = None
    metadata: Metadata = Metadata()
    pids: dict[Line, _Pid] = {}


class Entry(Reply):
    """A file of a draft: whole once its status is completed."""

    key: Line
    status: Line | None = None
    checksum: Line | None = None

    @property
    def md5(self) -> str | None:
        """MD5 in hexadecimal; None where the file is not whole."""
        return (self.checksum or "").removeprefix("md5:") if self.status == "completed" else None


class Entries(Reply):
    """The files of a draft; Zenodo takes a hundred, another archive perhaps some more."""

    entries: Annotated[list[Entry], Field(max_length=1000)]


def _tried(method: Callable[P, T]) -> Callable[P, T]:
    """Return a method of an archive that is tried again after a failure that may pass."""

    @wraps(method)
    def again(*given: P.args, **named: P.kwargs) -> T:
        archive: Any = given[0]
        return archive.retrying(method, *given, **named)  # type: ignore[no-any-return]

    return again


class Archive:
    """A conversation with one archive; every method may raise ArchiveError.

    Parameters
    ----------
    token : sent to it and to nobody else
    timeout : seconds that an answer may take
    sleep : waits so many seconds
    """

    def __init__(
        self,
        server: Server,
        token: SecretStr,
        *,
        timeout: float = 120.0,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.server = server
        self._token = token.get_secret_value()
        self._timeout = timeout
        self._http = httpx.Client(
            base_url=server.address,
            headers={
                "Authorization": f"Bearer {self._token}",
                "User-Agent": f"sun-sensor-atlas/{version()} (sunatlas deposit)",
                "Accept": "application/json",
                "Accept-Encoding": "identity",
            },
            timeout=httpx.Timeout(timeout, connect=30.0),
            # A proxy of the environment would see what goes to this machine in the clear.
            trust_env=server.address.startswith("https:"),
        )
        self.close = self._http.close
        self.retrying = tenacity.Retrying(
            retry=tenacity.retry_if_exception_type(MomentaryError),
            stop=tenacity.stop_after_attempt(TRIES),
            wait=_pause,
            sleep=sleep,
            reraise=True,
        )

    @_tried
    def create(self, document: dict[str, Any]) -> Record:
        """Open a draft of a new record; where the answer is lost, an empty one may be left over."""
        return self._ask("POST", _ALL, Record, json=document)

    @_tried
    def new_version(self, record: str) -> Record:
        """Open a draft of the next version with the files of the last, or find the one there is."""
        draft = self._ask("POST", f"{_at(record)}/versions", Record)
        if not self._files(draft.id):
            self._ask("POST", f"{_at(draft.id)}/draft/actions/files-import", Entries)
        return draft

    @_tried
    def draft(self, identifier: str) -> Record | None:
        """Look at a draft; None where there is none."""
        found = self._look(identifier, "/draft")
        # A published record that is being edited has a draft as well: not one for new files.
        return None if found is None or found.is_published else found

    @_tried
    def published(self, identifier: str) -> Record | None:
        """Look at a published record; None where there is none."""
        return self._look(identifier)

    @_tried
    def describe(self, draft: str, document: dict[str, Any]) -> None:
        """Give a draft this description; identifiers reserved for it are kept."""
        pids = self._ask("GET", f"{_at(draft)}/draft", Record).pids
        kept = {name: pid.model_dump(exclude_none=True) for name, pid in pids.items()}
        self._do("PUT", f"{_at(draft)}/draft", json={**document, "pids": kept})

    @_tried
    def files(self, draft: str) -> dict[str, Entry]:
        """List the files of a draft by name, halves among them."""
        return self._files(draft)

    @_tried
    def send(self, draft: str, name: str, path: Path, md5: str) -> str | None:
        """Declare, send and commit a file in place of one of this name; return its MD5 there."""
        where = f"{_at(draft)}/draft/files"
        one = f"{where}/{quote(name, safe='')}"
        there = self._files(draft).get(name)
        if there is not None and there.md5 == md5:
            return md5
        if there is not None:
            self._do("DELETE", one)
        self._ask("POST", where, Entries, json=[{"key": name}])
        with path.open("rb") as content:
            headers = {"Content-Type": "application/octet-stream"}
            self._do("PUT", f"{one}/content", content=content, headers=headers)
        return self._ask("POST", f"{one}/commit", Entry).md5

    @_tried
    def delete(self, draft: str, name: str) -> None:
        """Take a file out of a draft."""
        if name in self._files(draft):
            self._do("DELETE", f"{_at(draft)}/draft/files/{quote(name, safe='')}")

    @_tried
    def publish(self, draft: str) -> Record:
        """Make a draft public, for good."""
        if self._look(draft, "/draft") is None and (public := self._look(draft)) is not None:
            return public  # by a request whose answer was lost
        return self._ask("POST", f"{_at(draft)}/draft/actions/publish", Record)

    def _files(self, draft: str) -> dict[str, Entry]:
        listed = self._ask("GET", f"{_at(draft)}/draft/files", Entries).entries
        found = {entry.key: entry for entry in listed}
        if len(found) < len(listed):
            raise ArchiveError("the archive lists a file twice, expected one of a name")
        return found

    def _look(self, identifier: str, part: str = "") -> Record | None:
        try:
            found = self._ask("GET", f"{_at(identifier)}{part}", Record)
        except RefusedError as error:
            if error.status in {404, 410}:
                return None
            raise
        if found.id != identifier:
            raise ArchiveError(f"the archive answered of record {found.id}, expected {identifier}")
        return found

    def _ask(self, method: str, where: str, expected: type[R], **body: Any) -> R:
        """Ask once; return what the answer holds."""
        said = self._do(method, where, **body)
        try:
            return expected.model_validate_json(said)
        except ValidationError as error:
            first = error.errors(include_url=False, include_input=False)[0]
            place = ".".join(map(str, first["loc"])) or "the whole"
            text = f"{method} {where}: the answer cannot be read: {place}: {first['msg']}"
            raise ArchiveError(self._shown(text)) from None

    def _do(self, method: str, where: str, **body: Any) -> bytes:
        """Ask once; return the body of the answer."""
        try:
            with self._http.stream(method, where, **body) as answer:
                content = self._content(f"{method} {where}", answer)
        except (httpx.HTTPError, httpx.InvalidURL) as error:
            why = str(error) or type(error).__name__
            message = self._shown(f"{method} {where}: no whole answer ({why})")
            raise MomentaryError(message) from error
        if not answer.is_success:
            raise self._refusal(f"{method} {where}", answer, content)
        return content

    def _content(self, what: str, answer: httpx.Response) -> bytes:
        """Return the body of an answer: as it is sent, not unpacked, and not without end."""
        coding = answer.headers.get("Content-Encoding", "identity")
        if coding.strip().lower() not in {"", "identity"}:
            raise ArchiveError(self._shown(f"{what}: the answer is packed ({coding:.40})"))
        content, until = bytearray(), time.monotonic() + self._timeout
        for number, piece in enumerate(answer.iter_raw()):
            content += piece
            if len(content) > _LARGEST or number >= _MOST_PIECES:
                said = f"{_LARGEST} bytes, or comes in more than {_MOST_PIECES} pieces"
                raise ArchiveError(self._shown(f"{what}: the answer is longer than {said}"))
            if time.monotonic() > until:
                raise MomentaryError(self._shown(f"{what}: no whole answer (it comes too slowly)"))
        return bytes(content)

    def _refusal(self, what: str, answer: httpx.Response, content: bytes) -> ArchiveError:
        status = 302 if answer.has_redirect_location else answer.status_code
        advice = _ADVICE.get(status, "").format(
            variable=self.server.variable, address=self.server.address
        )
        json = "json" in answer.headers.get("Content-Type", "")
        reason = content[:2000].decode("utf-8", "replace") if json else ""
        parts = (f"{what}: {answer.status_code} {answer.reason_phrase}", advice, reason)
        message = self._shown("; ".join(part for part in parts if part))
        after = answer.headers.get("Retry-After", "")
        pause = float(after) if after.isascii() and after.isdigit() else None
        if status in {429, 500, 502, 503, 504} and (pause or 0) <= PATIENCE:
            return MomentaryError(message, pause)
        return RefusedError(message, answer.status_code)

    def _shown(self, text: str) -> str:
        """Return a text for a terminal, without the token where a server says it back."""
        shown = "".join(letter if letter.isprintable() else " " for letter in text)
        return shown.replace(self._token, "***")[:600]


def _at(identifier: str) -> str:
    """Return the path of a record."""
    if not re.fullmatch(_IDENTIFIER, identifier):
        raise ArchiveError(
            f"{identifier[:80]!r} is no identifier of a record: expected letters and digits, as in "
            "the record's address"
        )
    return f"{_ALL}/{identifier}"


def _pause(state: tenacity.RetryCallState) -> float:
    """Return how long to wait: as the server asks, else 1 s, 2 s, 4 s, ..."""
    error = state.outcome.exception() if state.outcome else None
    asked = error.pause if isinstance(error, MomentaryError) else None
    return 2.0 ** (state.attempt_number - 1) if asked is None else asked
