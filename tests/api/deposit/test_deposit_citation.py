"""Authors: read from CITATION.cff, sent to the archive, and refused while they are missing."""

import pytest

from api.deposit.archives.metadata import description
from api.metadata.citation import (
    Author,
    CitationError,
    author_problems,
    authors,
    check_digit,
    wrong_orcid,
)
from tests.api.deposit import small_bundle

ADA = Author("Sommer", "Ada", orcid="0009-0000-0012-3455")


@pytest.mark.parametrize(
    "orcid",
    # iDs that orcid.org itself prints, the second ending in X
    ["0000-0002-1825-0097", "0000-0002-1694-233X"],
)
def test_the_check_digit_is_orcid_s(orcid):
    digits = orcid.replace("-", "")
    assert check_digit(digits[:15]) == digits[15]


@pytest.mark.parametrize(
    ("orcid", "why"),
    [
        ("0000-0000-0000-0000", "mistyped"),
        ("0009000000123455", "is no ORCID iD"),
        ("0009-0000-0012-345", "is no ORCID iD"),
        ("todo", "is no ORCID iD"),
    ],
)
def test_what_is_nobody_s_orcid_is_refused(orcid, why):
    assert why in wrong_orcid(orcid)


@pytest.mark.parametrize(
    ("listed", "why"),
    [
        ((), "no person"),
        ((Author(name="The Sun Sensor Atlas contributors"),), "no person"),
        ((Author("Sommer", "Ada"),), "no ORCID"),
        ((Author("Sommer", "", orcid=ADA.orcid),), "no given name"),
        ((ADA, Author("", "Bea", orcid=ADA.orcid)), "no family name"),
    ],
)
def test_who_is_nobody_is_not_published(listed, why):
    assert any(why in text for text in author_problems(listed))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("authors: [", "not YAML"),
        ("title: x", "list of authors"),
        ("[]", "list of authors"),
        ("authors:\n  - Ada Sommer", "author 1: expected family-names"),
        ("authors:\n  - surname: Sommer", "author 1: expected family-names"),
        ("authors:\n  - name: 3", "author 1: expected text for name"),
    ],
)
def test_a_citation_that_cannot_be_read_is_named(text, why):
    with pytest.raises(CitationError, match=f"CITATION.cff.*{why}"):
        authors(text, "CITATION.cff")


def test_the_archive_is_told_data_set_survey_and_terms(tmp_path):
    draft = description(small_bundle.make(tmp_path / "bundle")).draft
    metadata = draft["metadata"]
    assert metadata["resource_type"] == {"id": "dataset"}
    assert [right["id"] for right in metadata["rights"]] == ["cc-by-4.0", "mit"]
    works = {"arXiv:2507.21541": "isderivedfrom", "10.5281/zenodo.15784429": "references"}
    works |= {"https://code.institute-of-light.org/sun/atlas": "iscompiledby"}
    related = metadata["related_identifiers"]
    assert {work["identifier"]: work["relation_type"]["id"] for work in related} == works
    assert metadata["publisher"] == "Zenodo"
    assert metadata["creators"] == [
        {
            "person_or_org": {
                "type": "personal",
                "family_name": "Sommer",
                "given_name": "Ada",
                "identifiers": [{"scheme": "orcid", "identifier": ADA.orcid}],
            },
            "affiliations": [{"name": "Institute of Light"}],
        }
    ]
