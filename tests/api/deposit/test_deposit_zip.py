"""Only the zip that a bundle makes is sent, and only the bytes that were verified."""

from __future__ import annotations

import datetime as dt
import os
import shutil
from pathlib import Path

import pytest

from api.deposit import limits
from api.deposit.archives import sealed as sealing
from api.deposit.archives.sealed import BundleError, ChangedError, SealedFile, seal
from api.deposit.packing import PackingError, check, pack
from api.deposit.verification import verify
from benchmark.datasets.checksums import write_checksums
from tests.api.deposit import small_bundle
from tests.api.deposit.altered_zips import TOP, more, thirteen
from tests.api.deposit.conftest import only

ALTERED = {**thirteen(), **more()}
RELEASED = dt.date(2026, 11, 21)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_bundle.make(tmp_path_factory.mktemp("whole") / "bundle")


@pytest.fixture
def copied(whole, tmp_path):
    shutil.copy(whole.with_name("bundle.zip"), tmp_path / "bundle.zip")
    return Path(shutil.copytree(whole, tmp_path / "bundle"))


def test_the_thirteen_are_thirteen():
    assert len(thirteen()) == 13
    assert len(more()) >= 20


@pytest.mark.parametrize("name", ALTERED)
@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_an_altered_zip_is_told_in_one_sentence(whole, tmp_path, name):
    packed = tmp_path / "bundle.zip"
    shutil.copy(whole.with_name("bundle.zip"), packed)
    before = packed.read_bytes()
    ALTERED[name](packed)
    assert packed.read_bytes() != before
    with pytest.raises(PackingError) as raised:
        check(packed, whole, TOP, RELEASED)
    assert str(raised.value).isprintable()
    assert len(str(raised.value)) < 400


@pytest.mark.filterwarnings("ignore:Duplicate name")
@pytest.mark.parametrize("name", ["../README.md", "encrypted", "an unknown compression"])
def test_of_a_bundle_with_an_altered_zip_nothing_is_sent(journey, name):
    ALTERED[name](journey.bundle.with_name("bundle.zip"))
    with pytest.raises(BundleError, match="not the zip of"):
        journey.upload()
    assert journey.archive.asked == []
    assert [path.name for path in journey.bundle.parent.iterdir() if path.name[0] == "."] == []


@pytest.mark.slow
def test_every_changed_byte_of_a_zip_is_seen(whole, tmp_path):
    """Each byte turned, but of what is packed only where the same comes out of it."""
    packed = tmp_path / "bundle.zip"
    data = whole.with_name("bundle.zip").read_bytes()
    check(whole.with_name("bundle.zip"), whole, TOP, RELEASED)
    for at in range(0, len(data), 7):
        packed.write_bytes(data[:at] + bytes([data[at] ^ 0x10]) + data[at + 1 :])
        with pytest.raises(PackingError):
            check(packed, whole, TOP, RELEASED)
    for length in range(0, len(data), 101):
        packed.write_bytes(data[:length])
        with pytest.raises(PackingError):
            check(packed, whole, TOP, RELEASED)


def test_a_zip_packed_by_another_zlib_is_the_same(whole, tmp_path, monkeypatch):
    import zipfile

    write = zipfile.ZipFile.writestr
    monkeypatch.setattr(
        zipfile.ZipFile, "writestr", lambda *a, compresslevel, **_: write(*a, compresslevel=1)
    )
    pack(whole, tmp_path / "other.zip", TOP, RELEASED)
    ours = whole.with_name("bundle.zip").read_bytes()
    assert (tmp_path / "other.zip").read_bytes() != ours
    check(tmp_path / "other.zip", whole, TOP, RELEASED)


@only("records")
@pytest.mark.parametrize("which", ["README.md", "sun-sensor-atlas-0.1.0.zip"])
def test_what_is_swapped_after_the_check_is_not_sent(journey, monkeypatch, which):
    wanted = journey.wanted()

    def swap(*arguments):
        (journey.bundle / "README.md").write_text("swapped")
        journey.bundle.with_name("bundle.zip").write_bytes(b"swapped")
        return described(*arguments)

    described = sealing.description
    monkeypatch.setattr(sealing, "description", swap)
    done = journey.upload()
    assert journey.archive.held(done.draft.id)[which] == wanted[which]


@only("records")
def test_a_copy_that_is_changed_while_it_is_sent_never_arrives_whole(journey):
    with seal(journey.bundle) as bundle:
        (readme,) = (file for name, file in bundle.files.items() if name == "README.md")
        assert b"".join(readme.chunks()) == (journey.bundle / "README.md").read_bytes()
        readme.path.write_bytes(b"# rEAD me\n")
        with pytest.raises(ChangedError, match=r"README\.md: changed after it was verified"):
            list(readme.chunks())
        assert oct(readme.path.parents[1].stat().st_mode & 0o777) == "0o700"
    assert not readme.path.exists()


@pytest.mark.parametrize("size", [0, 1, 1 << 20, (1 << 20) + 1, 5 << 20])
def test_the_last_bytes_wait_for_the_sum_of_all(tmp_path, size):
    path = tmp_path / "file"
    content = os.urandom(size)
    path.write_bytes(content)
    file = sealing._seal(path)
    assert b"".join(file.chunks()) == content
    for other in (content + b"x", content[:-1], content[:-1] + b"\xff" * 2):
        if other == content:
            continue
        path.write_bytes(other)
        sent: list[bytes] = []
        with pytest.raises(ChangedError):
            sent.extend(SealedFile(path, file.size, file.sha256, file.md5).chunks())
        assert len(b"".join(sent)) < size or size == 0


NAMES = {
    "readme.md": "systems that fold letters",
    "survey/NUL.txt": "is a device",
    "com1": "is a device",
    "a.": "no name of a file",
    "b\\c": "no name of a file",
    "d:e": "no name of a file",
}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_that_not_every_system_takes_is_found(copied, name):
    (copied / name).write_text("")
    write_checksums(copied)
    assert any(place == name and NAMES[name] in text for place, text in verify(copied))


def test_two_forms_of_one_letter_are_one_name():
    assert list(limits.unfit_names(["\u00e9", "e\u0301"]))
    assert list(limits.unfit_names(["STRASSE", "stra\u00dfe"]))
    assert not list(limits.unfit_names(["a/b", "a/c", "b/c", "checksums-sha256.txt"]))


def test_a_terabyte_of_nothing_is_refused_by_its_size(copied, monkeypatch):
    with (copied / "survey" / "hole.bin").open("wb") as file:
        file.truncate(1 << 40)
    monkeypatch.setattr("hashlib.file_digest", lambda *_: pytest.fail("it was hashed"))
    (place, text), *others = verify(copied)
    assert (place, others) == ("survey/hole.bin", [])
    assert "1,099,511,627,776 of" in text
    assert "at most 50,000,000,000" in text


@only("records")
@pytest.mark.parametrize("place", ["bundle/survey/hole.bin", "bundle.zip"])
def test_a_terabyte_of_nothing_is_not_copied(journey, place, monkeypatch):
    with (journey.bundle.parent / place).open("wb") as file:
        file.truncate(1 << 40)
    monkeypatch.setattr(shutil, "copyfile", lambda *_, **__: pytest.fail("it was copied"))
    with pytest.raises(BundleError, match="at most 50,000,000,000"):
        journey.upload()


def test_a_list_of_checksums_without_an_end_is_refused_by_its_size(copied):
    with (copied / "checksums-sha256.txt").open("ab") as file:
        file.truncate(100_000_000)
    ((place, text),) = verify(copied)
    assert place == "checksums-sha256.txt"
    assert "at most 50,000,000" in text


@only("records")
@pytest.mark.parametrize("kind", ["link", "pipe", "link to a directory"])
def test_what_is_no_file_is_not_read(journey, kind, tmp_path):
    path = journey.bundle / "README.md"
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/etc/hostname" if kind == "link" else tmp_path)
    with pytest.raises((BundleError, OSError), match=r"README\.md"):
        journey.upload()
    assert journey.archive.asked == []
