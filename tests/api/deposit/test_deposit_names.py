"""Names and sizes that not every system takes are found before a byte is read."""

from __future__ import annotations

from pathlib import Path

import pytest

from api.deposit import limits
from api.deposit.verification import verify
from files.checksums import write_checksums
from tests.api.deposit import small_bundle

NAMES = {
    "readme.md": "systems that fold letters",
    "survey/NUL.txt": "is a device",
    "com1": "is a device",
    "a.": "no name of a file",
    "b\\c": "no name of a file",
    "d:e": "no name of a file",
}


@pytest.fixture
def small(tmp_path: Path) -> Path:
    return small_bundle.make(tmp_path / "bundle")


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_not_every_system_takes_is_found(small, name):
    (small / name).write_text("")
    write_checksums(small)
    assert any(place == name and NAMES[name] in text for place, text in verify(small))


def test_two_forms_of_one_letter_are_one_name():
    assert list(limits.unfit_names(["\u00e9", "e\u0301"]))
    assert list(limits.unfit_names(["STRASSE", "stra\u00dfe"]))
    assert not list(limits.unfit_names(["a/b", "a/c", "b/c", "checksums-sha256.txt"]))


def test_a_terabyte_of_nothing_is_refused_by_its_size(small, monkeypatch):
    with (small / "survey" / "hole.bin").open("wb") as file:
        file.truncate(1 << 40)
    monkeypatch.setattr("hashlib.file_digest", lambda *_: pytest.fail("it was hashed"))
    (place, text), *others = verify(small)
    assert (place, others) == ("survey/hole.bin", [])
    assert "1,099,511,627,776 of" in text
    assert "at most 50,000,000,000" in text


def test_a_list_of_checksums_without_an_end_is_refused_by_its_size(small):
    with (small / "checksums-sha256.txt").open("ab") as file:
        file.truncate(100_000_000)
    ((place, text),) = verify(small)
    assert place == "checksums-sha256.txt"
    assert "at most 50,000,000" in text
