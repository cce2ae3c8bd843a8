"""Who the project is, in a checkout and where only the package is installed."""

import email.message

import pytest

from api.deposit.archives.archive import Metadata
from api.metadata import identity as deposit_identity
from api.metadata.identity import MissingFileError


class Installed:
    """Metadata as a wheel's."""

    def __init__(self, texts):
        self.texts = texts
        self.metadata = email.message.Message()
        self.metadata["Version"] = "9.8.7"
        self.metadata["Summary"] = 'Says "hello".'

    def read_text(self, name):
        return self.texts.get(name)


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """The package where no checkout is around it."""
    (tmp_path / "survey_data").mkdir()
    (tmp_path / "survey_data" / "LICENSE").write_text("data terms")
    monkeypatch.setattr(deposit_identity, "ROOT", tmp_path)
    deposit_identity.identity.cache_clear()
    yield monkeypatch
    deposit_identity.identity.cache_clear()


def test_an_installation_speaks_by_its_metadata(elsewhere):
    cited = "authors: [{name: A. Sun}, {name: B. Sensor}]\ndate-released: 1970-01-02\n"
    texts = {"licenses/LICENSE": "code terms", "licenses/CITATION.cff": cited}
    elsewhere.setattr(deposit_identity, "_installed", lambda: Installed(texts))
    who = deposit_identity.identity()
    terms = (who.version, who.code_licence, who.data_licence)
    assert terms == ("9.8.7", "code terms", "data terms")
    assert [author.name for author in who.authors] == ["A. Sun", "B. Sensor"]
    assert who.released.isoformat() == "1970-01-02"


def test_without_checkout_and_metadata_there_is_no_identity(elsewhere):
    elsewhere.setattr(deposit_identity, "_installed", lambda: None)
    with pytest.raises(MissingFileError, match="sun-sensor-atlas"):
        deposit_identity.version()


def test_authors_of_a_record_are_their_names_and_orcids_alone():
    who = [
        {"name": "Sommer, Ada", "family_name": "Sommer", "given_name": "Ada", "identifiers": [
            {"identifier": "0000 0001", "scheme": "isni"},
            {"identifier": "0009-0000-0012-3455", "scheme": "orcid"},
            {"identifier": "118-5", "scheme": "gnd"}, {"identifier": "x"},
        ]},
        {"name": "A team"},
    ]  # fmt: skip
    found = Metadata.model_validate({"creators": [{"person_or_org": one} for one in who]})
    assert found.authors == ["Sommer, Ada, 0009-0000-0012-3455", "A team"]
    assert Metadata().authors == []
