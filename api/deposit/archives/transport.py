"""Requests to one server: with the token to it and to nobody else, patient, and never in doubt.

A redirect is not followed and an address elsewhere is not asked. What fails for the moment (429,
5xx, a connection that drops) is tried again; before a request that must not happen twice is
repeated, `happened` looks whether it had arrived.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from types import TracebackType
from typing import Any, Self
from urllib.parse import urlsplit

import httpx

from api.deposit.archives.contract import ArchiveError, RefusedError, UnreachableError
from api.deposit.archives.server import Server, Token
from api.deposit.identity import version

#: Pauses before further tries, in seconds, where the server names none.
PAUSES = (1.0, 2.0, 4.0, 8.0, 16.0)
#: The longest that a server may have us wait, in seconds; it limits by the hour too.
PATIENCE = 900.0
_FOR_THE_MOMENT = frozenset({429, 500, 502, 503, 504})
_ADVICE = {
    401: "the token is not valid here; {variable} has to hold one made at {address}",
    403: "the token lacks a scope (deposit:write, deposit:actions), or the record is not yours",
    409: "the record is being changed elsewhere, or is locked; wait, then run the command again",
    413: "the file is larger than the archive takes",
}

Body = Callable[[], Iterable[bytes]]


@dataclass(frozen=True)
class Content:
    """Bytes to send: `chunks` starts from the first byte each time; `size` in bytes."""

    chunks: Body
    size: int


class Transport:
    """A conversation with one server.

    Parameters
    ----------
    server : whom to ask
    token : sent to it and to nobody else
    sleep : waits so many seconds
    timeout : seconds that an answer may take
    """

    def __init__(
        self,
        server: Server,
        token: Token,
        *,
        sleep: Callable[[float], None] = time.sleep,
        timeout: float = 120.0,
    ) -> None:
        self.server = server
        self._token = token
        self._sleep = sleep
        self._client = httpx.Client(
            headers={"User-Agent": f"sun-sensor-atlas/{version()} (sunatlas deposit)"},
            timeout=httpx.Timeout(timeout, connect=30.0),
            follow_redirects=False,
            # A proxy of the environment would see what goes to this machine in the clear.
            trust_env=not server.loopback,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._client.close()

    def ask(
        self,
        method: str,
        where: str,
        *,
        json: Any = None,
        content: Content | None = None,
        happened: Callable[[], Any] | None = None,
    ) -> Any:
        """Ask for one thing; return what the answer's JSON holds, None where it has no content.

        Parameters
        ----------
        method : of HTTP
        where : path on the server, or an address it gave
        json, content : body
        happened : asked after a failure that leaves open whether the request arrived; anything but
            None is taken for its answer

        Raises
        ------
        RefusedError
            Where the answer is a status that trying again does not change.
        UnreachableError
            Where no try had an answer.
        ArchiveError
            On a redirect, an address elsewhere, an answer that is no JSON.
        """
        url = self._address(where)
        what = f"{method} {urlsplit(url).path}"
        for pause in (*PAUSES, None):
            failure: ArchiveError
            asked: float | None = None
            try:
                answer = self._client.request(
                    method, url, json=json, **self._body(content), auth=self._signed
                )
            except httpx.HTTPError as error:
                failure = UnreachableError(self._said(f"{what}: {error or type(error).__name__}"))
            else:
                if answer.status_code not in _FOR_THE_MOMENT:
                    return self._understood(what, answer)
                failure = self._refusal(what, answer)
                asked = _asked_pause(answer.headers)
            # 429 says that nothing was done; after any other failure it may have been.
            limited = isinstance(failure, RefusedError) and failure.status == 429
            if happened is not None and not limited and (found := happened()) is not None:
                return found
            if pause is None or (asked or 0.0) > PATIENCE:
                raise failure
            self._sleep(pause if asked is None else asked)
        raise AssertionError("the last pause is None")

    def _address(self, where: str) -> str:
        url = where if "://" in where else f"{self.server.address}{where}"
        parts, ours = urlsplit(url), urlsplit(self.server.address)
        if (parts.scheme, parts.netloc) != (ours.scheme, ours.netloc):
            raise ArchiveError(
                self._said(
                    f"{self.server.address} sends us to {parts.scheme}://{parts.netloc}; the token "
                    "is for no other host, nothing was sent there"
                )
            )
        return url

    def _signed(self, request: httpx.Request) -> httpx.Request:
        request.headers["Authorization"] = self._token.header
        return request

    @staticmethod
    def _body(content: Content | None) -> dict[str, Any]:
        if content is None:
            return {}
        headers = {
            "Content-Type": "application/octet-stream",
            "Content-Length": str(content.size),
        }
        return {"content": content.chunks(), "headers": headers}

    def _understood(self, what: str, answer: httpx.Response) -> Any:
        if answer.is_redirect:
            elsewhere = urlsplit(answer.headers.get("Location", "")).netloc or "another address"
            raise ArchiveError(
                self._said(
                    f"{what}: redirected to {elsewhere}; redirects are not followed, so that "
                    "nobody else is sent the token"
                )
            )
        if not answer.is_success:
            raise self._refusal(what, answer)
        if not answer.content:
            return None
        try:
            return answer.json()
        except ValueError as error:
            kind = answer.headers.get("Content-Type", "no content type")
            raise ArchiveError(
                self._said(f"{what}: {answer.status_code} with {kind} instead of JSON")
            ) from error

    def _refusal(self, what: str, answer: httpx.Response) -> RefusedError:
        status = answer.status_code
        advice = _ADVICE.get(status, "").format(
            variable=self.server.variable, address=self.server.address
        )
        parts = (f"{what}: {status} {answer.reason_phrase}", _reasons(answer), advice)
        return RefusedError(self._said("; ".join(part for part in parts if part)), status)

    def _said(self, text: str) -> str:
        return self._token.hidden(" ".join(text.split()))[:600]


def _reasons(answer: httpx.Response) -> str:
    """Return what the server says of the refusal: its message and the fields it names."""
    try:
        told = answer.json()
    except ValueError:
        return ""
    if not isinstance(told, Mapping):
        return ""
    parts = [str(told["message"])] if told.get("message") else []
    for error in told.get("errors") or ():
        if isinstance(error, Mapping):
            said = error.get("messages") or [error.get("message", "")]
            text = " ".join(map(str, said)) if isinstance(said, list) else str(said)
            parts.append(f"{error.get('field', 'a field')}: {text}")
    return "; ".join(parts)


def _asked_pause(headers: Mapping[str, str]) -> float | None:
    """Return the seconds that a server asks to wait, None where it asks nothing."""
    after, reset = headers.get("Retry-After", ""), headers.get("X-RateLimit-Reset", "")
    if after.isdigit():
        return float(after)
    try:
        until = parsedate_to_datetime(after).timestamp() if after else float(reset)
    except ValueError:
        return None
    return max(0.0, until - datetime.now(UTC).timestamp())
