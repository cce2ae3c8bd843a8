"""Where an archive is and whose token it takes; what can go wrong with it."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass

from pydantic import SecretStr


class ArchiveError(ValueError):
    """An archive refused, failed or cannot be understood, or a bundle may not go there."""


@dataclass(frozen=True)
class Server:
    """An archive's address (scheme, host, port), and the environment variable of its token."""

    address: str
    variable: str

    def token(self) -> SecretStr:
        """Read the token from the environment.

        Raises
        ------
        ArchiveError
            Where there is none, or it is no word; what stands there is not said.
        """
        text = os.environ.get(self.variable, "").strip()
        if not text:
            raise ArchiveError(
                f"no token for {self.address}: make one there (Account, Applications, scopes "
                f"deposit:write and deposit:actions) and put it into the environment as "
                f"{self.variable}"
            )
        if not re.fullmatch(r"[\x21-\x7e]{8,}", text):
            raise ArchiveError(
                f"{self.variable} holds no token: expected one word of 8 letters or more"
            )
        return SecretStr(text)


SANDBOX = Server("https://sandbox.zenodo.org", "ZENODO_SANDBOX_TOKEN")
ZENODO = Server("https://zenodo.org", "ZENODO_TOKEN")
#: Plain HTTP is for this machine alone: it shows the token to the network.
_ADDRESS = re.compile(
    r"(https://[A-Za-z0-9.-]+|http://(127\.0\.0\.1|\[::1\]|localhost))(:[0-9]{1,5})?"
)


def server_at(address: str) -> Server:
    """Return another archive that runs InvenioRDM; its token is in ARCHIVE_TOKEN.

    Raises
    ------
    ArchiveError
        For anything but https://host[:port], or http:// to this machine.
    """
    plain = address.removesuffix("/")
    if not _ADDRESS.fullmatch(plain):
        raise ArchiveError(
            f"{address!r} is no address of an archive: expected https://host or https://host:port"
        )
    known = {server.address: server for server in (SANDBOX, ZENODO)}
    return known.get(plain, Server(plain, "ARCHIVE_TOKEN"))
