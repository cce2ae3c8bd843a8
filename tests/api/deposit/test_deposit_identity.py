"""Who the project is, in a checkout and where only the package is installed."""

import email.message

import pytest
import yaml

from api.metadata import identity as deposit_identity
from api.metadata.identity import MissingFileError


class Installed:
    """Metadata as a wheel's."""

    def __init__(self, texts):
        self.texts = texts
        self.metadata = email.message.Message()
        self.metadata["Version"] = "9.8.7"
        self.metadata["Summary"] = 'Says "hello".'
        self.metadata["Author"] = "A. Sun, B. Sensor"

    def read_text(self, name):
        return self.texts.get(name)


@pytest.fixture
def elsewhere(tmp_path, monkeypatch):
    """The package where no checkout is around it."""
    (tmp_path / "survey_data").mkdir()
    (tmp_path / "survey_data" / "LICENSE").write_text("data terms")
    monkeypatch.setattr(deposit_identity, "ROOT", tmp_path)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    deposit_identity.identity.cache_clear()
    yield monkeypatch
    deposit_identity.identity.cache_clear()


def test_an_installation_speaks_by_its_metadata(elsewhere):
    installed = Installed({"licenses/LICENSE": "code terms"})
    elsewhere.setattr(deposit_identity, "_installed", lambda: installed)
    who = deposit_identity.identity()
    assert (who.version, who.code_licence, who.data_licence) == (
        "9.8.7",
        "code terms",
        "data terms",
    )
    assert [author.name for author in who.authors] == ["A. Sun", "B. Sensor"]
    cited = yaml.safe_load(who.citation)
    assert cited["cff-version"] == "1.2.0"
    assert cited["version"] == "9.8.7"
    assert cited["abstract"] == 'Says "hello".'
    assert cited["authors"] == [{"name": "A. Sun"}, {"name": "B. Sensor"}]
    assert cited["date-released"] == "1970-01-02"


def test_without_checkout_and_metadata_there_is_no_identity(elsewhere):
    elsewhere.setattr(deposit_identity, "_installed", lambda: None)
    with pytest.raises(MissingFileError, match="sun-sensor-atlas"):
        deposit_identity.version()
