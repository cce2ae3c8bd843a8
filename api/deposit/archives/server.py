"""Where an archive is and who asks: its address, and a token that is never shown."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from urllib.parse import urlsplit

from api.deposit.archives.contract import ArchiveError

_LOOPBACK = frozenset({"127.0.0.1", "::1", "localhost"})


class ServerError(ArchiveError):
    """An address is none to which a token may be sent, or there is no token."""


@dataclass(frozen=True)
class Server:
    """An archive's address.

    Attributes
    ----------
    address : scheme, host and port, without a path
    variable : of the environment that holds the token
    """

    address: str
    variable: str

    @property
    def loopback(self) -> bool:
        """Whether it is this machine."""
        return urlsplit(self.address).hostname in _LOOPBACK


SANDBOX = Server("https://sandbox.zenodo.org", "ZENODO_SANDBOX_TOKEN")
ZENODO = Server("https://zenodo.org", "ZENODO_TOKEN")


def server_at(address: str) -> Server:
    """Return another archive that runs InvenioRDM; its token is in ARCHIVE_TOKEN.

    Raises
    ------
    ServerError
        For anything but https://host[:port], or http:// to this machine.
    """
    parts = urlsplit(address.rstrip("/"))
    plain = f"{parts.scheme}://{parts.netloc}"
    known = {server.address: server for server in (SANDBOX, ZENODO)}
    if plain in known and not parts.path:
        return known[plain]
    found = Server(plain, "ARCHIVE_TOKEN")
    safe = parts.scheme == "https" or (parts.scheme == "http" and found.loopback)
    if not safe or not parts.hostname or parts.username or plain != address.rstrip("/"):
        raise ServerError(
            f"{address!r} is no address of an archive: expected https://host or https://host:port"
        )
    return found


class Token:
    """A secret: it has no text but in the one header it is for."""

    __slots__ = ("_text",)

    def __init__(self, text: str) -> None:
        self._text = text

    def __repr__(self) -> str:
        return "Token(...)"

    def __reduce__(self) -> str:
        raise TypeError("a token is not stored")

    @property
    def header(self) -> str:
        """The value of `Authorization`."""
        return f"Bearer {self._text}"

    def hide(self, text: str) -> str:
        """Return a text without the token, where a server says it back."""
        return text.replace(self._text, "***")


def token_of(server: Server) -> Token:
    """Read the token of a server from the environment.

    Raises
    ------
    ServerError
        Where there is none, or it is no word; what stands there is not said.
    """
    text = os.environ.get(server.variable, "").strip()
    if not text:
        raise ServerError(
            f"no token for {server.address}: make one there (Account, Applications, scopes "
            f"deposit:write and deposit:actions) and put it into the environment as "
            f"{server.variable}"
        )
    if not re.fullmatch(r"[\x21-\x7e]{8,}", text):
        raise ServerError(
            f"{server.variable} holds no token: expected one word of 8 letters or more"
        )
    return Token(text)
