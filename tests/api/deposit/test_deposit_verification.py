"""Verification: what is wrong is named, and nothing found in a bundle is ever fetched."""

import json
import socket

import pytest

from api.deposit.crate import CRATE
from api.deposit.package import DESCRIPTOR
from api.deposit.verification import verify
from files.checksums import CHECKSUMS, read_checksums, sha256, write_checksums
from files.reading import FileRefusedError
from tests.api.deposit.test_deposit import files

ELSEWHERE = "http://127.0.0.1:9/elsewhere"


@pytest.fixture(autouse=True)
def offline(monkeypatch):
    """No test here may open a connection, whatever a bundle says."""
    asked = []

    def refuse(*arguments, **_options):
        asked.append(arguments)
        raise AssertionError(f"asked for {arguments}")

    for name in ("connect", "connect_ex"):
        monkeypatch.setattr(socket.socket, name, refuse)
    monkeypatch.setattr(socket, "getaddrinfo", refuse)
    monkeypatch.setattr(socket, "create_connection", refuse)
    yield asked
    assert asked == []


def change(bundle, edit, name=DESCRIPTOR):
    """Let `edit` change a document, and make crate and checksums agree with it."""
    document = json.loads((bundle / name).read_text("utf-8"))
    edit(document)
    (bundle / name).write_text(json.dumps(document))
    agree(bundle)


def agree(bundle):
    (bundle / CHECKSUMS).unlink()
    write_checksums(bundle)
    listed = read_checksums(bundle)
    try:
        crate = json.loads((bundle / CRATE).read_text("utf-8"))
        for entity in crate["@graph"]:
            if entity.get("@id") in listed:
                entity["sha256"] = listed[entity["@id"]]
                entity["contentSize"] = str((bundle / entity["@id"]).stat().st_size)
        (bundle / CRATE).write_text(json.dumps(crate))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        pass
    (bundle / CHECKSUMS).unlink()
    write_checksums(bundle)


def resource(name, value):
    return lambda package: package["resources"][0].__setitem__(name, value)


def schema(name, value):
    return lambda package: package["resources"][0]["schema"].__setitem__(name, value)


def field(name, value):
    return lambda package: package["resources"][0]["schema"]["fields"][0].__setitem__(name, value)


def package(name, value):
    return lambda document: document.__setitem__(name, value)


def test_a_small_bundle_holds(small):
    assert verify(small) == []
    agree(small)
    assert verify(small) == []


@pytest.mark.parametrize(
    "edit",
    [
        package("$schema", ELSEWHERE),
        package("resources", ELSEWHERE),
        package("name", "another"),
        resource("path", ELSEWHERE),
        resource("path", "../secret.csv"),
        resource("extrapaths", [ELSEWHERE]),
        resource("dialect", ELSEWHERE),
        resource("scheme", "http"),
        resource("data", [{"name": "a"}]),
        resource("bytes", 1),
        schema("$ref", ELSEWHERE),
        schema("foreignKeys", [{"fields": ["name"], "reference": {"package": ELSEWHERE}}]),
        schema(
            "foreignKeys",
            [{"fields": ["name"], "reference": {"resource": ELSEWHERE, "fields": ["a"]}}],
        ),
        field("constraints", {"jsonSchema": {"$ref": ELSEWHERE}}),
    ],
)
def test_a_descriptor_that_points_elsewhere_or_says_otherwise_is_refused_unasked(small, edit):
    change(small, edit)
    found = verify(small)
    assert found
    assert {name for name, _ in found} <= {DESCRIPTOR, "benchmark/one.csv"}


@pytest.mark.parametrize("text", ["", "[" * 100_000])
@pytest.mark.parametrize("name", [DESCRIPTOR, CRATE])
def test_a_document_that_is_none_is_named(small, name, text):
    (small / name).write_text(text)
    agree(small)
    assert name in {place for place, _ in verify(small)}


@pytest.mark.parametrize(
    "edit",
    [
        lambda crate: crate.__setitem__("@graph", ELSEWHERE),
        lambda crate: crate.__setitem__("@graph", []),
        lambda crate: crate["@graph"].pop(),
        lambda crate: crate["@graph"][0].__setitem__("conformsTo", {"@id": ELSEWHERE}),
        lambda crate: crate["@graph"].append({"@id": ELSEWHERE, "@type": "File"}),
        lambda crate: crate["@graph"][2].__setitem__("@id", "other.csv"),
    ],
)
def test_a_crate_that_says_otherwise_is_refused_unasked(small, edit):
    # the last entity of the graph is a licence: the one before the authors is a file
    document = json.loads((small / CRATE).read_text("utf-8"))
    document["@graph"] = [e for e in document["@graph"] if e["@type"] in ("CreativeWork", "File")]
    document["@graph"] = [e for e in document["@graph"] if not e["@id"].startswith("http")]
    (small / CRATE).write_text(json.dumps(document))
    agree(small)
    assert verify(small) == []
    change(small, edit, CRATE)
    assert CRATE in {name for name, _ in verify(small)}


@pytest.mark.slow
def test_a_flipped_byte_is_found_in_every_file(bundle):
    names = [name for name in files(bundle) if name != CHECKSUMS]
    assert len(names) > 20
    for name in names:
        content = (bundle / name).read_bytes()
        middle = len(content) // 2
        flipped = content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]
        (bundle / name).write_bytes(flipped)
        assert [place for place, _ in verify(bundle)] == [name]
        (bundle / name).write_bytes(content)
    assert verify(bundle) == []


def test_a_missing_and_an_added_file_are_found(small):
    (small / "benchmark" / "one.csv").rename(small / "benchmark" / "two.csv")
    assert verify(small) == [
        ("benchmark/one.csv", "listed but missing"),
        ("benchmark/two.csv", "not listed"),
    ]


@pytest.mark.slow
def test_a_wrong_table_is_found_though_its_checksum_holds(bundle):
    path = bundle / "survey" / "studies.csv"
    path.write_text(path.read_text("utf-8").replace(",2008,", ",MMVIII,", 1), "utf-8")

    def own_up(package):
        (entry,) = (r for r in package["resources"] if r["name"] == "studies")
        entry["bytes"] = path.stat().st_size
        entry["hash"] = f"sha256:{sha256(path)}"

    change(bundle, own_up)
    assert {name for name, _ in verify(bundle)} == {"survey/studies.csv"}


@pytest.mark.parametrize("line", ["abc  README.md", f"{'0' * 64}  ../secret"])
def test_a_list_of_checksums_that_is_none_is_refused(small, line):
    (small / CHECKSUMS).write_text(f"{line}\n")
    with pytest.raises(FileRefusedError, match="line 1"):
        read_checksums(small)
