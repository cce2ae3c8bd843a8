"""Who made the work and where its code is, as CITATION.cff says, and whether it may be archived.

CITATION.cff is the one file in which a person fills in authors, ORCIDs and repository; the bundle,
the archive's forms and the RO-Crate take them from it. An archive keeps names for good, so that
what is missing is refused before anything is sent.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from survey_data.editions import Edition

_ORCID = re.compile(r"(?:https?://orcid\.org/)?(\d{4}-\d{4}-\d{4}-\d{3}[\dX])")
_REPOSITORY = re.compile(r"https://([a-z0-9-]+\.)+[a-z]{2,}/\S+", re.IGNORECASE)


class CitationError(ValueError):
    """A CITATION.cff cannot be read; the message names file and entry."""


@dataclass(frozen=True)
class Author:
    """A person, or an organisation (`name`).

    Attributes
    ----------
    family, given : of a person, else empty
    name : of an organisation, else empty
    orcid : 0000-0000-0000-0000, or None
    affiliation : or None
    """

    family: str = ""
    given: str = ""
    name: str = ""
    orcid: str | None = None
    affiliation: str | None = None

    @property
    def title(self) -> str:
        """The name as people write it."""
        return self.name or " ".join(part for part in (self.given, self.family) if part)

    @property
    def sort_name(self) -> str:
        """The name as indices sort it."""
        return self.name or ", ".join(part for part in (self.family, self.given) if part)

    def to_dict(self) -> dict[str, Any]:
        """Return the author as schema.org describes a person or an organisation."""
        if self.name:
            return {"@type": "Organization", "name": self.name}
        affiliation = {"@type": "Organization", "name": self.affiliation}
        return {
            "@type": "Person",
            **({"@id": f"https://orcid.org/{self.orcid}"} if self.orcid else {}),
            "name": self.title,
            "givenName": self.given,
            "familyName": self.family,
            **({"affiliation": affiliation} if self.affiliation else {}),
        }


def authors(text: str, where: str | Path) -> tuple[Author, ...]:
    """Read the authors of a CITATION.cff (Citation File Format 1.2.0).

    Raises
    ------
    CitationError
        Where the text is no YAML, has no list of authors, or an entry is neither person nor
        organisation.
    """
    try:
        document = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise CitationError(f"{where}: not YAML ({' '.join(str(error).split())})") from error
    listed = document.get("authors") if isinstance(document, Mapping) else None
    if not isinstance(listed, list):
        raise CitationError(f"{where}: expected a list of authors")
    return tuple(_author(entry, f"{where}, author {n}") for n, entry in enumerate(listed, start=1))


def repository(text: str) -> str | None:
    """Return the `repository-code` of a CITATION.cff; None where it has none."""
    return str((yaml.safe_load(text) or {}).get("repository-code") or "").strip() or None


def unfilled(listed: Sequence[Author], address: str | None) -> list[str]:
    """Say which fields of a CITATION.cff an archive demands and does not find; empty where none."""
    found = [f"authors: {said}" for said in author_problems(listed)]
    if address is None:
        expected = "missing; expected the address of the public repository"
        return [*found, f"repository-code: {expected}"]
    if not _REPOSITORY.fullmatch(address):
        said = f"{address!r} is no address of a public repository (https://...)"
        return [*found, f"repository-code: {said}"]
    return found


def persistent(text: str) -> str | None:
    """Return the DOI that a CITATION.cff gives the work as an address; None where it gives none.

    Parameters
    ----------
    text : of the file; its `doi`, else the first of its `identifiers` that is one
    """
    cited = yaml.safe_load(text) or {}
    named = [cited.get("doi")]
    named += [i.get("value") for i in cited.get("identifiers", ()) if i.get("type") == "doi"]
    found = next((str(doi) for doi in named if doi), None)
    return f"https://doi.org/{found.removeprefix('https://doi.org/')}" if found else None


def of_dataset(text: str, record: str | None = None, editions: Sequence[Edition] = ()) -> str:
    """Return a CITATION.cff whose `type` says that it goes with a data set, not with code.

    Parameters
    ----------
    text : of the project's own
    record : SHA-256 of the published results' manifest, to be named as an identifier
    editions : of the studies, each to be named by its version
    """
    document = {**yaml.safe_load(text), "type": "dataset"}
    said = "SHA-256 of the manifest of the published results, as the leaderboard shows it"
    named = [(f"sha256:{record}", said)] if record is not None else []
    named += [
        (
            f"{one.name}:{one.version}",
            f"{one.title} ({one.studies}): version of the edition `{one.name}`",
        )
        for one in editions
    ]
    document["identifiers"] = [
        *document.get("identifiers", ()),
        *({"type": "other", "value": value, "description": said} for value, said in named),
    ]
    return str(yaml.safe_dump(document, sort_keys=False, allow_unicode=True))


def _author(entry: Any, where: str) -> Author:
    known = {"family-names", "given-names", "name-particle", "name-suffix", "name"}
    known |= {"orcid", "affiliation", "email", "website", "alias"}
    if not isinstance(entry, Mapping) or not known.issuperset(entry):
        strange = sorted(map(str, set(entry) - known)) if isinstance(entry, Mapping) else entry
        raise CitationError(f"{where}: expected family-names, given-names, orcid; got {strange!r}")
    wrong = [key for key, value in entry.items() if not isinstance(value, str | None)]
    if wrong:
        raise CitationError(f"{where}: expected text for {wrong[0]}, got {entry[wrong[0]]!r}")
    text = {key: " ".join((value or "").split()) for key, value in entry.items()}
    family = " ".join(filter(None, (text.get("name-particle"), text.get("family-names"))))
    given = " ".join(filter(None, (text.get("given-names"), text.get("name-suffix"))))
    found = _ORCID.fullmatch(text.get("orcid", ""))
    return Author(
        family,
        given,
        "" if family or given else text.get("name", ""),
        (found[1] if found else text.get("orcid")) or None,
        text.get("affiliation") or None,
    )


def check_digit(digits: str) -> str:
    """Return the last character of an ORCID iD of these 15 digits (ISO 7064, mod 11-2)."""
    total = 0
    for digit in digits:
        total = (total + int(digit)) * 2
    rest = (12 - total % 11) % 11
    return "X" if rest == 10 else str(rest)


def wrong_orcid(orcid: str) -> str | None:
    """Say what is wrong with an ORCID iD; None where nothing is."""
    if not _ORCID.fullmatch(orcid):
        return f"{orcid!r} is no ORCID iD: expected 0000-0000-0000-0000, the last a digit or X"
    digits = orcid.replace("-", "")
    expected = check_digit(digits[:15])
    if digits[15] != expected:
        return f"{orcid} is mistyped: its last character would have to be {expected}"
    return None


def author_problems(listed: Sequence[Author]) -> list[str]:
    """Say why these authors may not be published; empty where they may.

    At least one person, each with family name, given name and a valid ORCID iD.
    """
    people = [author for author in listed if author.family or author.given]
    found = [] if people else ["no person among the authors"]
    for author in people:
        parts = (("family name", author.family), ("given name", author.given))
        found += [f"{author.title}: no {kind}" for kind, part in parts if not part]
        if author.orcid is None:
            found.append(f"{author.title}: no ORCID iD")
        elif wrong := wrong_orcid(author.orcid):
            found.append(f"{author.title}: {wrong}")
    return found
