"""The code in a bundle: the project's source distribution, its digest in every list."""

import tarfile

import pytest

from api.deposit import code_archive
from api.deposit.code_archive import CodeArchiveError, write_code

pytestmark = pytest.mark.slow


def archive(bundle):
    (found,) = (bundle / "code").iterdir()
    return found


def test_the_archive_holds_the_code_its_lock_file_and_no_more_than_the_checkout(built):
    with tarfile.open(archive(built.directory)) as packed:
        names = {member.name.split("/", 1)[1] for member in packed}
        top = {member.name.split("/", 1)[0] for member in packed}
    assert top == {"sun_sensor_atlas-0.1.0"}
    wanted = {"pyproject.toml", "requirements.lock", "LICENSE", "CITATION.cff"}
    wanted |= {"benchmark/published/checksums-sha256.txt", "tests/api/deposit/test_deposit_code.py"}
    assert wanted <= names
    ours = {name for name in names if name != "PKG-INFO"}
    assert [name for name in sorted(ours) if not (code_archive.ROOT / name).is_file()] == []
    assert not [
        name for name in names if "__pycache__" in name or name.startswith((".venv", "out"))
    ]


def test_the_same_checkout_is_packed_to_the_same_bytes(built, tmp_path):
    write_code(tmp_path)
    assert archive(tmp_path).read_bytes() == archive(built.directory).read_bytes()
    assert (tmp_path / "rescore.py").read_bytes() == (built.directory / "rescore.py").read_bytes()


def test_an_installation_is_handed_the_archive(built, tmp_path, monkeypatch):
    monkeypatch.setattr(code_archive, "ROOT", tmp_path)
    (tmp_path / "a").mkdir()
    with pytest.raises(CodeArchiveError, match=r"no sources.* --code"):
        write_code(tmp_path / "a")
    (tmp_path / "b").mkdir()
    with pytest.raises(CodeArchiveError, match="expected a source distribution"):
        write_code(tmp_path / "b", tmp_path / "a.zip")
    (tmp_path / "c").mkdir()
    write_code(tmp_path / "c", archive(built.directory))
    assert archive(tmp_path / "c").read_bytes() == archive(built.directory).read_bytes()
