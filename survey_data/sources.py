"""Where a fact is from, by name: addresses, and which of them may be linked to.

A source is a survey label, a study's key, the name of a document, or an address of a host that
``sources.csv`` names. Mirrors, document-sharing sites and indexes of other publishers' records
stand there too, and no source may be of one.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from urllib.parse import urlsplit

from survey_data import labels
from survey_data.texts import load_texts

#: Kinds of hosts that hold what others published.
REFUSED = frozenset({"mirror", "document sharing", "index"})
_ADDRESS = re.compile(r"https?://\S+")
_DOI = "doi.org"
_HOST_LIKE = re.compile(r"[a-z0-9-]+(?:\.[a-z0-9-]+){2,}|[a-z0-9-]+\.[a-z]{2,}")
_NUMBER = re.compile(r"[0-9.]+|\[?[0-9a-f:]*:[0-9a-f:.]*\]?")


@dataclass(frozen=True)
class Host:
    """Who publishes at a host, and of which kind it is (see ``datapackage.json``)."""

    host: str
    name: str
    kind: str


@dataclass(frozen=True)
class Source:
    """A source as a reader sees it: a name, and the address behind it where there is one."""

    name: str
    link: str = ""


@cache
def hosts() -> Mapping[str, Host]:
    """Return the hosts of ``sources.csv`` by name; SurveyDataError if they cannot be read."""
    return {row["host"]: Host(**row) for row in load_texts(("sources",)).sources}


def source_named(text: str) -> Source:
    """Return what a source is called, and where it leads.

    A DOI is written as one, another address as its publisher, a label of the survey as its name.
    An address that `fault` refuses is named by its host, if it has one, and leads nowhere.
    """
    if not text.startswith(("http://", "https://")):
        return Source(labels.label_of(text))
    if fault(text):
        try:
            return Source(_host(text))
        except ValueError:  # no address at all
            return Source(text)
    host = _host(text)
    if host == _DOI:
        return Source("doi:" + urlsplit(text).path.lstrip("/"), text)
    known = _known(host, hosts())
    return Source(host if known is None else known.name, text)


def fault(text: str, known: Mapping[str, Host] | None = None) -> str:
    """Say why a cell of a column ``source`` or ``url`` is no source to cite; empty where it is one.

    `known` are the hosts by name; by default those of ``sources.csv``.
    """
    if "://" not in text:
        return _hidden_address(text, hosts() if known is None else known)
    if not _ADDRESS.fullmatch(text):
        return f"an address stands alone in a source; got {text!r}"
    try:
        host, port = _host(text), urlsplit(text).port
    except ValueError as error:
        return f"no address: {error}"
    if port is not None or "@" in urlsplit(text).netloc:
        return f"expected a host by its name alone, got {urlsplit(text).netloc!r}"
    return _fault_of(host, hosts() if known is None else known)


def _fault_of(host: str, known: Mapping[str, Host]) -> str:
    """Say why nothing at a host can be cited; empty where it can."""
    if _NUMBER.fullmatch(host) or "." not in host:
        return f"a raw address ({host}); cite the study's DOI or its publisher's page"
    found = _known(host, known)
    if found is None:
        return f"sources.csv does not say who publishes at {host}; cite a DOI, or add the host"
    if found.kind in REFUSED:
        what = f"{host} is of the kind {found.kind!r}, which is no source"
        return f"{what}; cite the study's DOI or its publisher's page, and name it in the note"
    return ""


def _hidden_address(text: str, known: Mapping[str, Host]) -> str:
    """Say which address stands in a name without its scheme, where it may not be linked to."""
    for word in _HOST_LIKE.findall(text.casefold()):
        found = _known(word.removeprefix("www."), known)
        if _NUMBER.fullmatch(word) or (found is not None and found.kind in REFUSED):
            return f"{word} stands in a source; name the document, and the address in the note"
    return ""


def _host(address: str) -> str:
    return (urlsplit(address).hostname or "").rstrip(".").removeprefix("www.")


def _known(host: str, known: Mapping[str, Host]) -> Host | None:
    """Return the row of a host, or else of the nearest domain that it is a part of."""
    parts = host.split(".")
    for start in range(len(parts) - 1):
        found = known.get(".".join(parts[start:]))
        if found is not None:
            return found
    return None
