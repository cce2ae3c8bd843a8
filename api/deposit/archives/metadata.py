"""Metadata of the bundle for the archive, in the words of both interfaces of Zenodo.

The invenio form follows InvenioRDM's metadata reference (docs-invenio-rdm,
`reference/metadata.md`), the legacy one the table of `developers.zenodo.org`. Both say the same,
as far as the second can.
"""

from __future__ import annotations

import html
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from api.deposit.archives.contract import ArchiveError
from api.metadata.citation import Author, authors, repository, unfilled

Scheme = Literal["arxiv", "doi", "url"]


class UnfilledError(ArchiveError):
    """A person has still to fill in fields of CITATION.cff; the message names them."""


@dataclass(frozen=True)
class RelatedWork:
    """Another work, and what it is to this one.

    Attributes
    ----------
    identifier, scheme : of the work
    relation : of this one to it, in DataCite's words
    kind : (of InvenioRDM, of the legacy interface)
    """

    identifier: str
    scheme: Scheme
    relation: str
    kind: tuple[str, str]


#: The survey that the facts were compiled from; its authors' own table, which is another
#: compilation of the same studies and is not contained here.
RELATED = (
    RelatedWork(
        "arXiv:2507.21541",
        "arxiv",
        "isDerivedFrom",
        ("publication-preprint", "publication-preprint"),
    ),
    RelatedWork("10.5281/zenodo.15784429", "doi", "references", ("dataset", "dataset")),
)


_CONTENTS = (
    "{zip} holds everything; README.md says what, with an example. The SQLite file holds every "
    "table, the bibliography every study that is identified."
)


@dataclass(frozen=True)
class Description:
    """Metadata of a version of the bundle.

    Attributes
    ----------
    title, version : of the bundle
    released : YYYY-MM-DD
    text : paragraphs, plain
    authors : as CITATION.cff names them
    keywords : free
    licences : (SPDX identifier, what it covers), that of the data first
    repository : address of the code, or None
    """

    title: str
    version: str
    released: str
    text: tuple[str, ...]
    authors: tuple[Author, ...]
    keywords: tuple[str, ...]
    licences: tuple[tuple[str, str], ...]
    repository: str | None

    @property
    def related(self) -> tuple[RelatedWork, ...]:
        """Other works: the sources of the facts, and the code that made the rest."""
        if self.repository is None:
            return RELATED
        code = RelatedWork(self.repository, "url", "isCompiledBy", ("software", "software"))
        return (*RELATED, code)

    @property
    def unfilled(self) -> list[str]:
        """Fields of CITATION.cff that an archive demands and that are missing or placeholders."""
        return unfilled(self.authors, self.repository)

    def require_filled(self, undone: str) -> None:
        """Raise UnfilledError where CITATION.cff lacks a field; `undone` is what was not done."""
        if self.unfilled:
            raise UnfilledError(
                f"CITATION.cff of the bundle is not filled in: {'; '.join(self.unfilled)}. Fill in "
                f"the project's own, build and upload again; {undone}"
            )

    @property
    def html(self) -> str:
        """The paragraphs, and which licence covers what, as HTML."""
        terms = "; ".join(f"{covered}: {name}" for name, covered in self.licences)
        paragraphs = (*self.text, f"Licences: {terms}.")
        return "".join(f"<p>{html.escape(part, quote=False)}</p>" for part in paragraphs)


def description(bundle: Path) -> Description:
    """Read what a bundle says of itself, in datapackage.json and CITATION.cff.

    Raises
    ------
    CitationError
        Where the authors cannot be read.
    """
    package = json.loads((bundle / "datapackage.json").read_text("utf-8"))
    path = bundle / "CITATION.cff"
    citation = path.read_text("utf-8")
    return Description(
        title=package["title"],
        version=package["version"],
        released=package["created"][:10],
        text=(
            package["description"],
            _CONTENTS.format(zip=f"{package['name']}-{package['version']}.zip"),
        ),
        authors=authors(citation, path),
        keywords=tuple(package["keywords"]),
        licences=(
            ("CC-BY-4.0", "facts (survey/, bibliography/)"),
            ("MIT", "code, and what it measured and made (everything else)"),
        ),
        repository=repository(citation),
    )


def invenio(described: Description) -> dict[str, Any]:
    """Return the body of a draft for InvenioRDM's records interface."""
    return {
        "access": {"record": "public", "files": "public"},
        "files": {"enabled": True},
        "metadata": {
            "resource_type": {"id": "dataset"},
            "title": described.title,
            "publication_date": described.released,
            "creators": [_creator(author) for author in described.authors],
            "description": described.html,
            "rights": [{"id": name.lower()} for name, _ in described.licences],
            "version": described.version,
            "publisher": "Zenodo",  # without one no DOI is registered
            "languages": [{"id": "eng"}],
            "subjects": [{"subject": keyword} for keyword in described.keywords],
            "related_identifiers": [
                {
                    "identifier": work.identifier,
                    "scheme": work.scheme,
                    "relation_type": {"id": work.relation.lower()},
                    "resource_type": {"id": work.kind[0]},
                }
                for work in described.related
            ],
        },
    }


def legacy(described: Description) -> dict[str, Any]:
    """Return the `metadata` of a deposition; of the licences it can name only the first."""
    return {
        "title": described.title,
        "upload_type": "dataset",
        "description": described.html,
        "creators": [
            {
                "name": author.sort_name,
                **({"orcid": author.orcid} if author.orcid else {}),
                **({"affiliation": author.affiliation} if author.affiliation else {}),
            }
            for author in described.authors
        ],
        "access_right": "open",
        "license": described.licences[0][0].lower(),
        "version": described.version,
        "publication_date": described.released,
        "keywords": list(described.keywords),
        "language": "eng",
        "related_identifiers": [
            {
                "identifier": work.identifier,
                "relation": work.relation,
                "resource_type": work.kind[1],
            }
            for work in described.related
        ],
    }


def _creator(author: Author) -> dict[str, Any]:
    if author.name:
        who: dict[str, Any] = {"type": "organizational", "name": author.name}
    else:
        who = {"type": "personal", "family_name": author.family, "given_name": author.given}
    if author.orcid:
        who["identifiers"] = [{"scheme": "orcid", "identifier": author.orcid}]
    affiliations = [{"name": author.affiliation}] if author.affiliation else []
    return {"person_or_org": who, **({"affiliations": affiliations} if affiliations else {})}
