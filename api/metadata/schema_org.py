"""What pages are about, in the words of schema.org: JSON-LD for their heads.

Addresses are paths on this service, which a reader resolves against the page's own.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from api.metadata.citation import persistent
from api.metadata.identity import LICENCES, SCHEMA, Identity
from api.metadata.served import SUBJECTS
from api.metadata.signposting import LandingPage
from registry.catalogue import Implementation

Entity = dict[str, Any]

CONTEXT = SCHEMA.rstrip("/")
CATALOGUE = "/#catalogue"
SOFTWARE = "/#software"


def atlas(who: Identity, datasets: Iterable[str]) -> Entity:
    """Return catalogue and software, which the home page is about."""
    catalogue = {
        "@type": "DataCatalog",
        "@id": CATALOGUE,
        **_work(who),
        "license": [LICENCES["MIT"], LICENCES["CC-BY-4.0"]],
        "keywords": list(SUBJECTS),
        "dataset": [
            {"@type": "Dataset", "@id": f"/datasets/{name}#dataset", "name": name}
            for name in datasets
        ]
        + [{"@type": "Dataset", "@id": "/leaderboard#dataset", "name": "leaderboard"}],
    }
    software = {
        "@type": "SoftwareApplication",
        "@id": SOFTWARE,
        **_work(who),
        "license": LICENCES["MIT"],
        "softwareVersion": who.version,
        "applicationCategory": "Science",
        "softwareHelp": {"@type": "CreativeWork", "url": "/guide/"},
    }
    return {"@context": CONTEXT, "@graph": [catalogue, software]}


def dataset(
    card: Mapping[str, Any], who: Identity, landing: LandingPage, variables: Mapping[str, str]
) -> Entity:
    """Return a data set.

    Parameters
    ----------
    card : of the data set
    who : made it
    landing : its page
    variables : meaning of what is measured, by name
    """
    name = card["name"]
    return {
        "@context": CONTEXT,
        "@type": "Dataset",
        "@id": f"{landing.path}#dataset",
        **_terms(who, landing),
        "name": f"{who.title}: {name}",
        "alternateName": name,
        "description": card["description"],
        "version": str(card["version"]),
        "keywords": [*SUBJECTS, card["detector"], card["mask"], card["observation"]],
        "measurementTechnique": "simulation",
        "variableMeasured": [
            {"@type": "PropertyValue", "name": variable, "description": meaning}
            for variable, meaning in variables.items()
        ],
        "isBasedOn": [f"/studies/{key}" for key in card["follows"]],
        "includedInDataCatalog": {"@id": CATALOGUE},
        "distribution": _downloads(landing),
    }


def record(who: Identity, landing: LandingPage, digest: str | None) -> Entity:
    """Return the leaderboard; `digest` is the SHA-256 of its manifest."""
    named = {"@type": "PropertyValue", "propertyID": "SHA-256", "value": digest}
    return {
        "@context": CONTEXT,
        "@type": "Dataset",
        "@id": f"{landing.path}#dataset",
        **_terms(who, landing),
        "name": f"{who.title}: leaderboard",
        "description": "Errors of every pipeline on simulated sun sensors, ranked within each data "
        "set and condition beside the Cramer-Rao bound.",
        "version": who.version,
        **({"identifier": named} if digest else {}),
        "keywords": list(SUBJECTS),
        "measurementTechnique": "simulation",
        "includedInDataCatalog": {"@id": CATALOGUE},
        "distribution": _downloads(landing),
    }


def study(row: Mapping[str, Any], landing: LandingPage) -> Entity:
    """Return a mapped study; what is not known of it is left out.

    Parameters
    ----------
    row : key, title, authors (separated by semicolons), year, venue and doi
    landing : its page
    """
    doi, year = row["doi"], row["year"]
    people = [one.strip() for one in (row["authors"] or "").split(";") if one.strip()]
    given = {
        "@context": CONTEXT,
        "@type": "ScholarlyArticle",
        "@id": f"{landing.path}#study",
        "url": landing.path,
        "alternateName": row["key"],
        "name": row["title"],
        "headline": row["title"],
        "author": [{"@type": "Person", "name": name} for name in people],
        "datePublished": None if year is None else str(year),
        "isPartOf": {"@type": "CreativeWork", "name": row["venue"]} if row["venue"] else None,
        "sameAs": landing.identifier,
        "identifier": {"@type": "PropertyValue", "propertyID": "doi", "value": doi}
        if doi
        else None,
    }
    return {name: value for name, value in given.items() if value not in (None, "", [])}


def algorithm(one: Implementation, who: Identity, landing: LandingPage) -> Entity:
    """Return an implementation."""
    return {
        "@context": CONTEXT,
        "@type": "SoftwareSourceCode",
        "@id": f"{landing.path}#code",
        **_terms(who, landing),
        "name": one.name,
        "description": one.summary,
        "version": str(one.version),
        "programmingLanguage": "Python",
        "isBasedOn": [f"/studies/{key}" for key in one.studies],
        "isPartOf": {"@id": SOFTWARE},
    }


def _work(who: Identity) -> Entity:
    doi = persistent(who.citation)
    return {
        "name": who.title,
        "description": who.summary,
        "url": "/",
        "version": who.version,
        "datePublished": who.released.isoformat(),
        "creator": [author.to_dict() for author in who.authors],
        "isAccessibleForFree": True,
        **({"sameAs": doi} if doi else {}),
    }


def _terms(who: Identity, landing: LandingPage) -> Entity:
    return {
        "url": landing.path,
        **({"license": LICENCES[landing.licence]} if landing.licence else {}),
        "creator": [author.to_dict() for author in who.authors],
        "datePublished": who.released.isoformat(),
        "isAccessibleForFree": True,
    }


def _downloads(landing: LandingPage) -> Sequence[Entity]:
    return [
        {"@type": "DataDownload", "contentUrl": item.target, "encodingFormat": item.media_type}
        for item in landing.items
    ]
