"""What a bundle, its parts or its zip may not be, and where the message says so."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from frictionless import FrictionlessException, Resource, system

from api.deposit import verification
from api.deposit.bundle import DepositError, build
from api.deposit.crate import CRATE
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import verify
from files.checksums import CHECKSUMS, write_checksums
from tests.api.deposit.test_deposit_verification import agree


def without(bundle: Path, name: str) -> None:
    """Take a file out of a bundle, of whose absence nothing but the file itself tells then."""
    (bundle / name).unlink()
    crate = json.loads((bundle / CRATE).read_text("utf-8"))
    crate["@graph"] = [entity for entity in crate["@graph"] if entity["@id"] != name]
    (bundle / CRATE).write_text(json.dumps(crate))
    agree(bundle)  # type: ignore[no-untyped-call]


@pytest.mark.parametrize("name", ["LICENSE", "survey/LICENSE"])
def test_a_bundle_without_its_terms_is_told_which_are_missing(small: Path, name: str) -> None:
    without(small, name)
    assert verify(small) == [(name, "missing; a bundle goes out with its terms")]


def test_a_crate_with_another_size_is_found(small: Path) -> None:
    crate = json.loads((small / CRATE).read_text("utf-8"))
    for entity in crate["@graph"]:
        if entity["@id"] == "README.md":
            entity["contentSize"] = "1"
    (small / CRATE).write_text(json.dumps(crate))
    (small / CHECKSUMS).unlink()
    write_checksums(small)
    assert verify(small) == [(CRATE, "README.md: contentSize is not its size")]


def test_what_reads_tables_has_no_way_to_the_web_while_a_bundle_is_verified() -> None:
    """A reader that were to follow an address is refused before it asks anybody."""
    with system.use_context(http_session=verification._Offline()):
        resource = Resource(path="http://127.0.0.1:9/one.csv")
        with pytest.raises(FrictionlessException, match="a bundle is verified offline"):
            resource.open()  # type: ignore[no-untyped-call]


def test_an_earlier_bundle_may_be_built_over_and_a_changed_one_may_not(small: Path) -> None:
    """Tables with problems are refused after that, so that nothing is built here."""
    nothing = small.with_name("nothing")
    nothing.mkdir()
    with pytest.raises(DepositError, match=r"the survey's tables have \d+ problems"):
        build(small, survey=nothing)
    (small / "notes.txt").write_text("mine")
    with pytest.raises(DepositError, match=r"holds notes\.txt, which is no part"):
        build(small, survey=nothing)
    (small / "notes.txt").unlink()
    package = json.loads((small / DESCRIPTOR).read_text("utf-8"))
    (small / DESCRIPTOR).write_text(json.dumps({**package, "name": "another"}))
    with pytest.raises(DepositError, match="holds another data package, which is no part"):
        build(small, survey=nothing)


@pytest.mark.parametrize("content", [b"", b"PK", b"no zip at all"])
def test_a_file_beside_a_bundle_that_is_not_its_zip_is_not_replaced(
    tmp_path: Path, content: bytes
) -> None:
    path = tmp_path / "out.zip"
    path.write_bytes(content)
    with pytest.raises(DepositError, match=r"out\.zip: not the zip of an earlier bundle"):
        build(tmp_path / "out")
    assert path.read_bytes() == content
