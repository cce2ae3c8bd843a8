"""Requests to one server: the token goes to it alone; retries are patient and safe.

An address elsewhere is not asked, and a redirect is followed to the same server alone, where
something is only looked at. What fails for the moment (429, 5xx, a connection that drops) is tried
again; before a request that must not happen twice is repeated, `happened` looks whether it had
arrived. An answer has a limit in bytes (`reading`) and in time.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from types import TracebackType
from typing import Any, Self, TypeVar
from urllib.parse import urljoin, urlsplit

import httpx

from api.deposit.archives.contract import ArchiveError, RefusedError, UnreachableError
from api.deposit.archives.deadline import Deadline
from api.deposit.archives.refusals import reasons
from api.deposit.archives.responses import R, ReplyError, holds_json, parse_response, read_response
from api.deposit.archives.server import Server, Token
from api.metadata.identity import version

#: Pauses before further tries, in seconds, where the server names none.
PAUSES = (1.0, 2.0, 4.0, 8.0, 16.0)
#: The longest that a server may have us wait, in seconds; it limits by the hour too.
PATIENCE = 900.0
#: Redirects that are followed one after another.
HOPS = 3
_FOR_THE_MOMENT = frozenset({429, 500, 502, 503, 504})
_ADVICE = {
    401: "the token is not valid here; {variable} has to hold one made at {address}",
    403: "the token lacks a scope (deposit:write, deposit:actions), or the record is not yours",
    409: "the record is being changed elsewhere, or is locked; wait, then run the command again",
    413: "the file is larger than the archive takes",
    429: "the archive limits how often it is asked; wait some minutes, then run the command again",
    503: "the archive is out of service for the moment; run the command again later",
}

Body = Callable[[], Iterable[bytes]]
#: The head of an answer and its body.
Answer = tuple[httpx.Response, bytes]
T = TypeVar("T")


@dataclass(frozen=True)
class Content:
    """Bytes to send: `chunks` starts from the first byte each time; `size` in bytes."""

    chunks: Body
    size: int


@dataclass(frozen=True)
class _Request:
    method: str
    url: str
    json: Any = None
    content: Content | None = None

    @property
    def what(self) -> str:
        return f"{self.method} {urlsplit(self.url).path}"


class Transport:
    """A conversation with one server.

    Parameters
    ----------
    server : whom to ask
    token : sent to it and to nobody else
    sleep : waits so many seconds
    timeout : seconds that an answer may take, from the last byte sent to the last received
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
        self._deadline = Deadline(timeout)
        self._client = httpx.Client(
            headers={
                "User-Agent": f"sun-sensor-atlas/{version()} (sunatlas deposit)",
                "Accept": "application/json",
                "Accept-Encoding": "gzip",
            },
            limits=httpx.Limits(max_connections=1),  # the one that the deadline ends
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
        expected: type[R],
        *,
        json: Any = None,
        content: Content | None = None,
        happened: Callable[[], R | None] | None = None,
    ) -> R:
        """Ask for one thing; return what the answer holds.

        Parameters
        ----------
        method : of HTTP
        where : path on the server, or an address it gave
        expected : model of the answer
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
            On a redirect elsewhere, an address elsewhere, an answer that is not `expected`, too
            large or too slow.
        """
        request = _Request(method, self._address(where), json, content)
        return self._tried(request, happened, lambda got: parse_response(*got, expected))

    def tell(
        self, method: str, where: str, *, json: Any = None, content: Content | None = None
    ) -> None:
        """Have something done of which only matters that it is; raises as `ask`."""
        self._tried(_Request(method, self._address(where), json, content), None, lambda _got: None)

    def _tried(
        self,
        request: _Request,
        happened: Callable[[], T | None] | None,
        read: Callable[[Answer], T],
    ) -> T:
        what = request.what
        for pause in (*PAUSES, None):
            failure: ArchiveError
            asked: float | None = None
            limited = False
            try:
                answer = self._follow(request)
                if answer[0].status_code not in _FOR_THE_MOMENT:
                    if not answer[0].is_success:
                        raise self._refusal(what, answer)
                    return read(answer)
                failure = self._refusal(what, answer)
                asked = _asked_pause(answer[0].headers)
                # 429 says that nothing was done; after any other failure it may have been.
                limited = failure.status == 429
            except (httpx.HTTPError, httpx.InvalidURL) as error:
                said = f"({error or type(error).__name__})"
                if self._deadline.passed:
                    said = f"within {self._deadline.seconds:g} s"
                failure = UnreachableError(self._said(f"{what}: no whole answer {said}"))
            except ReplyError as error:
                raise ReplyError(
                    self._said(f"{what}: the answer cannot be read: {error}")
                ) from error
            if happened is not None and not limited and (found := happened()) is not None:
                return found
            if pause is None or self._deadline.passed or (asked or 0.0) > PATIENCE:
                raise failure
            self._sleep(pause if asked is None else asked)
        raise AssertionError("the last pause is None")

    def _follow(self, request: _Request) -> Answer:
        """Return an answer that is no redirect: what is only looked at may be elsewhere here."""
        url = request.url
        for _ in range(HOPS):
            answer = self._once(request, url)
            if not answer[0].has_redirect_location:
                return answer
            url = urljoin(url, answer[0].headers["Location"])
            if request.method != "GET" or not self._is_here(url):
                break
        raise ArchiveError(
            self._said(
                f"{request.what}: redirected to {_host(url)}; redirects are not followed but to "
                "the same server and where nothing is changed, so that nobody else is sent the "
                "token"
            )
        )

    def _once(self, request: _Request, url: str) -> Answer:
        with (
            self._deadline,
            self._client.stream(
                request.method,
                url,
                json=request.json,
                **self._body(request.content),
                auth=self._signed,
                extensions={"trace": self._deadline.watch},
            ) as answer,
        ):
            return answer, read_response(answer)

    def _address(self, where: str) -> str:
        url = where if "://" in where else f"{self.server.address}{where}"
        if not self._is_here(url):
            raise ArchiveError(
                self._said(
                    f"{self.server.address} sends us to {_host(url)}; the token is for no other "
                    "host, nothing was sent there"
                )
            )
        return url

    def _is_here(self, url: str) -> bool:
        ours = urlsplit(self.server.address)
        try:
            parts = urlsplit(url)
        except ValueError:
            return False
        return (parts.scheme, parts.netloc) == (ours.scheme, ours.netloc)

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

    def _refusal(self, what: str, answer: Answer) -> RefusedError:
        status = answer[0].status_code
        advice = _ADVICE.get(status, "").format(
            variable=self.server.variable, address=self.server.address
        )
        reason = reasons(*answer) if holds_json(answer[0]) else ""
        parts = (f"{what}: {status} {answer[0].reason_phrase}", reason, advice)
        return RefusedError(self._said("; ".join(part for part in parts if part)), status)

    def _said(self, text: str) -> str:
        shown = "".join(letter if letter.isprintable() else " " for letter in text)
        return self._token.hide(" ".join(shown.split()))[:600]


def _host(url: str) -> str:
    """Return scheme and host of an address, to be shown."""
    try:
        parts = urlsplit(url)
    except ValueError:
        return f"{url[:80]!r}, which is no address"
    return f"{parts.scheme}://{parts.netloc}"


def _asked_pause(headers: Mapping[str, str]) -> float | None:
    """Return the seconds that a server asks to wait, None where it asks nothing."""
    after, reset = headers.get("Retry-After", ""), headers.get("X-RateLimit-Reset", "")
    try:
        if after.isascii() and after.isdigit():
            return float(after)
        until = parsedate_to_datetime(after).timestamp() if after else float(reset)
    except (ValueError, OverflowError):
        return None
    return None if math.isnan(until) else max(0.0, until - datetime.now(UTC).timestamp())
