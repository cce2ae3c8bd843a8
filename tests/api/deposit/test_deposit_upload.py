"""A bundle goes into a draft and is published, whatever the archive answers; the token stays."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import pytest

from api.deposit.archives.archive import Archive, RefusedError
from api.deposit.archives.server import SANDBOX, ZENODO, ArchiveError, SecretStr, server_at
from api.deposit.archives.uploading import publish, upload
from tests.api.deposit import small_bundle
from tests.api.deposit.standin import TOKEN, StandIn

ZIP = "sun-sensor-atlas-0.1.0.zip"
STEPS = ("create", "describe", "list", "declare", "send", "commit")
REFUSED = tuple(zip(STEPS, (302, 400, 401, 403, 409, 413), strict=True))


class Journey:
    """A bundle, an archive that takes it, and how long the client waited."""

    def __init__(self, bundle: Path, archive: StandIn) -> None:
        self.bundle, self.archive, self.pauses = bundle, archive, []
        self.client = Archive(
            server_at(archive.address), SecretStr(TOKEN), sleep=self.pauses.append, timeout=2.0
        )

    def upload(self, **options):
        return upload(self.client, self.bundle, **options)

    def publish(self, draft):
        return publish(self.client, draft, self.bundle)

    def is_whole(self, draft):
        held = self.archive.files(draft)
        names = ("README.md", "bibliography/studies.bib", "bibliography/studies.ris")
        whole = {Path(name).name: (self.bundle / name).read_bytes() for name in names}
        whole["sun-sensor-atlas.sqlite"] = (self.bundle / "sun-sensor-atlas.sqlite").read_bytes()
        whole[ZIP] = self.bundle.with_name("bundle.zip").read_bytes()
        return held == whole


@pytest.fixture
def journey(tmp_path):
    with StandIn() as archive:
        made = Journey(small_bundle.make(tmp_path / "bundle"), archive)
        yield made
        made.client.close()


def test_an_upload_publishes_nothing_and_a_second_sends_nothing(journey):
    told = []
    draft = journey.upload(tell=lambda *one: told.append(one)).draft.id
    assert journey.is_whole(draft)
    assert {state for _, state in told} == {"sent"}
    assert not journey.archive.records
    reserved = journey.archive.drafts[draft]["pids"]
    again = journey.upload()
    assert (again.draft.id, set(again.files.values())) == (draft, {"there already"})
    assert len(journey.archive.sent()) == 5
    assert journey.archive.drafts[draft]["pids"] == reserved
    small_bundle.make(journey.bundle, readme="# another\n")
    changed = journey.upload(draft=draft).files
    assert {name for name, state in changed.items() if state == "sent"} == {"README.md", ZIP}
    metadata = journey.archive.drafts[draft]["metadata"]
    assert [right["id"] for right in metadata["rights"]] == ["cc-by-4.0", "mit"]
    assert metadata["creators"][0]["person_or_org"]["family_name"] == "Sommer"
    assert (metadata["publication_date"], metadata["version"]) == ("2026-11-21", "0.1.0")


def test_a_published_record_has_a_next_version_without_its_old_files(journey):
    first = journey.upload().draft.id
    public = journey.publish(first)
    assert (public.id, public.pids["doi"].identifier) == (first, f"10.5072/zenodo.{first}")
    with pytest.raises(ArchiveError, match=f"--new-version {first}"):
        journey.upload()
    with pytest.raises(ArchiveError, match="is published already; nothing was published"):
        journey.publish(first)
    files = journey.archive.records[first]["files"]
    files["old.zip"] = {**files["README.md"], "key": "old.zip"}
    done = journey.upload(version_of=first)
    assert done.draft.id != first
    assert done.files == {**dict.fromkeys(files, "there already"), "old.zip": "removed"}
    assert journey.is_whole(done.draft.id)


@pytest.mark.parametrize(
    ("step", "kind"),
    [
        # each step with one kind of failure; slow are the others
        pytest.param(step, kind, marks=() if (k + n) % 3 == 0 else pytest.mark.slow)
        for k, step in enumerate((*STEPS, "version", "import", "delete", "publish"))
        for n, kind in enumerate((429, "drop before", "drop after"))
    ],
)
def test_a_failure_for_the_moment_is_survived(journey, kind, step):
    """Whether or not the request arrived, nothing is done twice."""
    if step in {*STEPS, "publish"}:
        journey.archive.fault(step, kind)
        draft = journey.upload().draft.id
        assert len(journey.archive.sent()) <= 6
    else:
        first = journey.upload().draft.id
        journey.publish(first)
        small_bundle.make(journey.bundle, readme="# second\n")
        journey.archive.fault(step, kind)
        draft = journey.upload(version_of=first).draft.id
    assert journey.is_whole(draft)
    journey.publish(draft)
    assert draft in journey.archive.records
    assert not [n for n, kept in journey.archive.drafts.items() if kept["files"]]
    assert journey.pauses == [7.0 if isinstance(kind, int) else 1.0]


@pytest.mark.parametrize(("step", "kind"), REFUSED)
def test_a_refusal_ends_an_upload_without_the_token_and_the_next_goes_on(journey, step, kind):
    journey.archive.fault(step, kind)
    with pytest.raises(RefusedError, match=f"{kind}.*you sent Bearer \\*\\*\\*") as refused:
        journey.upload()
    assert TOKEN not in repr(refused.value)
    assert journey.pauses == []
    assert journey.is_whole(journey.upload().draft.id)
    assert len(journey.archive.drafts) == 1
    assert journey.archive.signed == {f"Bearer {TOKEN}"}
    kept = [path for path in journey.bundle.parent.rglob("*") if path.is_file()]
    assert not [path for path in kept if TOKEN.encode() in path.read_bytes()]


def test_an_archive_that_stays_away_or_asks_for_hours_is_given_up(journey):
    journey.archive.fault("create", b"", 99)
    with pytest.raises(ArchiveError, match="no whole answer"):
        journey.upload()
    assert journey.pauses == [1, 2, 4, 8, 16]
    journey.archive.fault("create", b"HTTP/1.1 429 No\r\nRetry-After: 7200\r\n\r\n")
    with pytest.raises(RefusedError, match="429"):
        journey.upload()


def test_a_wrong_checksum_is_sent_again_and_not_for_ever(journey):
    journey.archive.fault("send", "wrong checksum")
    assert journey.is_whole(journey.upload().draft.id)
    small_bundle.make(journey.bundle, readme="# another\n")
    journey.archive.fault("send", "wrong checksum", 99)
    with pytest.raises(ArchiveError, match="sent 3 times"):
        journey.upload()


def answer(body: bytes, *headers: str) -> bytes:
    head = "\r\n".join(["HTTP/1.1 200 OK", "Content-Type: application/json", *headers])
    return f"{head}\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body


HOSTILE = {
    "a bomb": answer(gzip.compress(bytes(50 << 20)), "Content-Encoding: gzip"),
    "no member": answer(b"{}"),
    "a path": answer(b'{"id": "../../users"}'),
    "escape codes": answer(b'{"id": "a", "pids": {"\\u001b[2J": {"identifier": ""}}}'),
}


@pytest.mark.parametrize(
    ("step", "name"), [*(("create", name) for name in HOSTILE), ("publish", "no member")]
)
def test_any_answer_ends_in_one_sentence(journey, step, name):
    draft = journey.upload().draft.id if step == "publish" else ""
    journey.archive.fault(step, HOSTILE[name], 99)
    with pytest.raises(ArchiveError) as raised:
        journey.publish(draft) if draft else journey.upload()
    assert str(raised.value).isprintable()
    assert 10 < len(str(raised.value)) <= 600
    assert not journey.archive.records


ENDLESS = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"


@pytest.mark.parametrize(
    ("said", "why"),
    [
        (answer(gzip.compress(bytes(50 << 20)), "Content-Encoding: gzip"), "is packed"),
        (answer(b" " * 5_000_000), "is longer than 4000000 bytes"),
        (answer(b" " * 5_000_000).replace(b"200 OK", b"400 No"), "is longer than 4000000 bytes"),
        (ENDLESS + b"1\r\n \r\n" * 25_000, "in more than 20000 pieces"),
    ],
)
def test_an_answer_is_neither_unpacked_nor_read_without_end(journey, said, why):
    """2 GB of spaces are 2 MB packed, and took 3 GB here."""
    journey.archive.fault("create", said, 99)
    with pytest.raises(ArchiveError, match=why):
        journey.upload()
    assert journey.pauses == []


def test_an_answer_that_drips_is_given_up(journey, monkeypatch):
    clock = iter(range(0, 10**6, 5))
    monkeypatch.setattr("api.deposit.archives.archive.time.monotonic", lambda: next(clock))
    journey.archive.fault("create", ENDLESS + b"1\r\n \r\n" * 9, 99)
    with pytest.raises(ArchiveError, match="it comes too slowly"):
        journey.upload()
    assert journey.pauses == [1, 2, 4, 8, 16]


@pytest.mark.parametrize("charset", ["idna", "rot13", "zlib", "utf-7"])
def test_the_charset_of_a_refusal_is_not_believed(journey, charset):
    """Some of Python's encodings are of no text, and end in errors of their own."""
    said = answer(b"\xffno").replace(b"/json", f"/json; charset={charset}".encode())
    journey.archive.fault("create", said.replace(b"200 OK", b"400 No"))
    with pytest.raises(RefusedError, match=r"400 No.*no$"):
        journey.upload()


@pytest.mark.parametrize(
    ("people", "why"),
    [
        (small_bundle.PLACEHOLDER, "authors: no person.*repository-code: missing"),
        (small_bundle.PEOPLE.replace("0009-0000", "0009-0001"), "authors: .*mistyped"),
        (small_bundle.NOWHERE, "not filled in: repository-code: missing"),
    ],
)
def test_a_citation_that_lacks_a_field_is_neither_sent_nor_published(journey, people, why):
    draft = journey.upload().draft.id
    asked = len(journey.archive.asked)
    small_bundle.make(journey.bundle, people)
    for act, undone in ((journey.upload, "sent"), (lambda: journey.publish(draft), "published")):
        with pytest.raises(ArchiveError, match=f"{why}.*; nothing was {undone}$"):
            act()
    assert len(journey.archive.asked) == asked


def test_a_draft_that_is_not_the_bundle_is_not_published(journey):
    draft = journey.upload().draft.id
    kept = journey.archive.drafts[draft]
    kept["files"]["notes.txt"] = {**kept["files"]["README.md"], "key": "notes.txt"}
    assert journey.upload().remaining_files == ("notes.txt",)
    with pytest.raises(ArchiveError, match=r"notes\.txt missing, foreign or of other bytes"):
        journey.publish(draft)
    del kept["files"]["notes.txt"]
    kept["metadata"]["creators"] = [{"person_or_org": {"name": "Contributors"}}]
    with pytest.raises(ArchiveError, match="authors of draft"):
        journey.publish(draft)
    with pytest.raises(ArchiveError, match="77 is no unpublished draft"):
        journey.publish("77")
    assert not journey.archive.records


def test_a_bundle_that_does_not_hold_or_a_draft_that_is_none_is_not_sent(journey, tmp_path):
    for draft, why in (("77", "no unpublished draft 77"), ("../77", "is no identifier")):
        with pytest.raises(ArchiveError, match=why):
            journey.upload(draft=draft)
    memory = journey.bundle.with_name("bundle.drafts.json")
    for text in ("[]", "{", '{"a": {"draft": 3}}'):
        memory.write_text(text)
        with pytest.raises(ArchiveError, match=r"bundle\.drafts\.json: does not say"):
            journey.upload()
    memory.unlink()
    readme = journey.bundle / "README.md"
    readme.write_text("other")
    with pytest.raises(ArchiveError, match=r"README\.md: SHA-256"):
        journey.upload()
    for make in (os.mkfifo, lambda path: path.symlink_to(tmp_path)):
        readme.unlink()
        make(readme)
        with pytest.raises(ArchiveError, match=r"README\.md"):
            journey.upload()
    assert [step for step, _ in journey.archive.asked] == ["draft"]


def test_each_server_has_a_token_of_its_own(monkeypatch):
    monkeypatch.setenv("ZENODO_TOKEN", TOKEN)
    for server in (SANDBOX, server_at("https://archive.example")):
        monkeypatch.delenv(server.variable, raising=False)
        with pytest.raises(ArchiveError, match=f"as {server.variable}"):
            server.token()
    assert TOKEN not in f"{ZENODO.token()!r} {ZENODO.token()}"
    for text in ("two words here", "line\nbreak-in-it", "short", "ünicode-token"):
        monkeypatch.setenv("ZENODO_SANDBOX_TOKEN", text)
        with pytest.raises(ArchiveError, match="holds no token") as refused:
            SANDBOX.token()
        assert text not in str(refused.value)
    assert server_at("https://zenodo.org/") == ZENODO


@pytest.mark.parametrize(
    "address",
    [
        *("http://zenodo.org", "zenodo.org", "https://me:secret@zenodo.org"),
        *("https://zenodo.org/api", "http://127.0.0.1.evil.example"),
    ],
)
def test_an_address_to_which_no_token_may_go_is_refused(address):
    with pytest.raises(ArchiveError, match="no address of an archive"):
        server_at(address)
