"""A bundle's metadata in InvenioRDM's words (docs-invenio-rdm, `reference/metadata.md`)."""

from __future__ import annotations

import html
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from api.metadata.citation import Author, authors, repository, unfilled

#: Of each other work: identifier, scheme, relation to it, kind. The survey that the facts were
#: compiled from; its authors' own table, another compilation, not contained here.
_RELATED = (
    ("arXiv:2507.21541", "arxiv", "isderivedfrom", "publication-preprint"),
    ("10.5281/zenodo.15784429", "doi", "references", "dataset"),
)
_LICENCES = {
    "CC-BY-4.0": "facts (survey/, bibliography/)",
    "MIT": "code, and what it measured and made (everything else)",
}


@dataclass(frozen=True)
class Description:
    """Metadata of a version of the bundle.

    Attributes
    ----------
    draft : body of a draft
    version, released : of the bundle; the day as YYYY-MM-DD
    unfilled : fields of CITATION.cff that are missing
    """

    draft: dict[str, Any]
    version: str
    released: str
    unfilled: list[str]


def description(bundle: Path) -> Description:
    """Read what a bundle says of itself, in datapackage.json and CITATION.cff.

    Raises
    ------
    CitationError
        Where the authors cannot be read.
    """
    package = json.loads((bundle / "datapackage.json").read_text("utf-8"))
    citation = (bundle / "CITATION.cff").read_text("utf-8")
    people, code = authors(citation, bundle / "CITATION.cff"), repository(citation)
    version, released = package["version"], package["created"][:10]
    contents = (
        f"{package['name']}-{version}.zip holds everything; README.md says what, with an example. "
        "The SQLite file holds every table, the bibliography every study that is identified."
    )
    terms = "; ".join(f"{covered}: {name}" for name, covered in _LICENCES.items())
    text = (package["description"], contents, f"Licences: {terms}.")
    related = [*_RELATED, *([(code, "url", "iscompiledby", "software")] if code else [])]
    metadata = {
        "resource_type": {"id": "dataset"},
        "title": package["title"],
        "publication_date": released,
        "creators": [_creator(author) for author in people],
        "description": "".join(f"<p>{html.escape(part, quote=False)}</p>" for part in text),
        "rights": [{"id": name.lower()} for name in _LICENCES],
        "version": version,
        "publisher": "Zenodo",  # without one no DOI is registered
        "languages": [{"id": "eng"}],
        "subjects": [{"subject": keyword} for keyword in package["keywords"]],
        "related_identifiers": [
            {
                "identifier": identifier,
                "scheme": scheme,
                "relation_type": {"id": relation},
                "resource_type": {"id": kind},
            }
            for identifier, scheme, relation, kind in related
        ],
    }
    access = {"record": "public", "files": "public"}
    draft = {"access": access, "files": {"enabled": True}, "metadata": metadata}
    return Description(draft, version, released, unfilled(people, code))


def _creator(author: Author) -> dict[str, Any]:
    if author.name:
        who: dict[str, Any] = {"type": "organizational", "name": author.name}
    else:
        who = {"type": "personal", "family_name": author.family, "given_name": author.given}
    if author.orcid:
        who["identifiers"] = [{"scheme": "orcid", "identifier": author.orcid}]
    affiliations = [{"name": author.affiliation}] if author.affiliation else []
    return {"person_or_org": who, **({"affiliations": affiliations} if affiliations else {})}
