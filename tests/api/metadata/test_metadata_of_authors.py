"""Metadata name authors as schema.org does."""

from __future__ import annotations

import dataclasses

import pytest

from api.metadata.citation import Author
from api.metadata.croissant import DatasetDescription, cite_as, croissant
from api.metadata.identity import Identity, identity

WHAT = DatasetDescription("Atlas: pd-slit", "A data set.", None, "1.0.0", ("sun sensor",))
ORCID = "0000-0002-1825-0097"
PERSON = Author(family="Sun", given="Ada", orcid=ORCID, affiliation="A University")
ALONE = Author(family="Plato")
TEAM = Author(name="The Atlas Team")


@pytest.fixture
def who() -> Identity:
    """The project as if three had made it."""
    return dataclasses.replace(identity(), authors=(PERSON, ALONE, TEAM))


def test_croissant_tells_persons_from_organisations(who: Identity) -> None:
    creators = croissant(WHAT, who, [], [])["creator"]
    assert creators == [
        {
            "@type": "sc:Person",
            "name": "Ada Sun",
            "givenName": "Ada",
            "familyName": "Sun",
            "url": f"https://orcid.org/{ORCID}",
        },
        {"@type": "sc:Person", "name": "Plato", "givenName": "", "familyName": "Plato"},
        {"@type": "sc:Organization", "name": "The Atlas Team"},
    ]
    assert "author = {Sun, Ada and Plato and {The Atlas Team}}" in cite_as(WHAT, who)
