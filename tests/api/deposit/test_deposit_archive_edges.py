"""Rare answers of an archive and rare wishes of a user: each ends in a sentence or goes well."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import pytest

from api.deposit.archives.contract import ArchiveError, NoDraftError, RefusedError
from api.deposit.archives.deadline import Deadline
from api.deposit.archives.replies import Deposition, Record, unless_missing
from api.deposit.archives.responses import ReplyError, parse_response, short
from api.deposit.archives.sealed import BundleError, seal
from api.deposit.archives.server import Token, server_at
from api.deposit.archives.transport import Transport
from api.deposit.packing import pack
from tests.api.deposit import small_bundle
from tests.api.deposit.altered_zips import TOP
from tests.api.deposit.conftest import Journey, only
from tests.api.deposit.standins.server import TOKEN
from tests.api.deposit.test_deposit_refusals import without
from tests.api.deposit.test_deposit_zip import RELEASED

NOWHERE = "http://127.0.0.1:9"
JSON = httpx.Response(200, headers={"Content-Type": "application/json"})


@only("records")
def test_a_draft_to_go_on_with_and_a_record_to_follow_are_not_asked_for_at_once(
    journey: Journey,
) -> None:
    with pytest.raises(ArchiveError, match="--draft goes on with a draft, --new-version opens one"):
        journey.upload(version_of="1", draft="2")
    assert journey.archive.asked == []


@only("records")
def test_a_named_draft_is_gone_on_with_whether_or_not_it_is_remembered(journey: Journey) -> None:
    memory = journey.bundle.with_name("bundle.drafts.json")
    draft = journey.upload().draft.id
    remembered = json.loads(memory.read_text("utf-8"))
    for text in ("{}", json.dumps(remembered)):
        memory.write_text(text)
        done = journey.upload(draft=draft)
        assert (done.draft.id, set(done.files.values())) == (draft, {"there already"})
        assert json.loads(memory.read_text("utf-8")) == remembered


@only("records")
def test_a_memory_of_a_version_that_is_no_text_is_named(journey: Journey) -> None:
    memory = journey.bundle.with_name("bundle.drafts.json")
    memory.write_text('{"a b": {"draft": "3", "version_of": 5}}')
    with pytest.raises(BundleError, match=r"bundle\.drafts\.json: does not say which draft"):
        journey.upload()
    assert journey.archive.asked == []


@only("records")
def test_a_draft_that_neither_is_there_nor_was_published_cannot_be_published(
    journey: Journey,
) -> None:
    with pytest.raises(NoDraftError, match="no unpublished draft 77"):
        journey.publish("77")


@only("records")
def test_a_next_version_that_has_its_files_already_is_given_no_others(journey: Journey) -> None:
    first = journey.upload().draft.id
    journey.publish(first)
    draft = journey.upload(version_of=first).draft.id
    journey.bundle.with_name("bundle.drafts.json").unlink()
    again = journey.upload(version_of=first)
    assert (again.draft.id, set(again.files.values())) == (draft, {"there already"})
    assert len(journey.archive.calls("POST", "/actions/files-import")) == 1


@pytest.mark.parametrize("kind", ["missing", "a link"])
def test_a_bundle_without_a_zip_of_its_own_is_not_sealed(tmp_path: Path, kind: str) -> None:
    bundle = small_bundle.make(tmp_path / "bundle")
    packed = bundle.with_name("bundle.zip")
    packed.rename(tmp_path / "elsewhere.zip")
    if kind == "a link":
        packed.symlink_to(tmp_path / "elsewhere.zip")
    with pytest.raises(BundleError, match=r"bundle\.zip: missing, or no plain file"), seal(bundle):
        pass


@pytest.mark.parametrize("name", ["README.md", "bibliography/studies.ris"])
def test_a_bundle_that_holds_but_lacks_what_is_sent_beside_its_zip_is_not_sealed(
    tmp_path: Path, name: str
) -> None:
    bundle = small_bundle.make(tmp_path / "bundle")
    without(bundle, name)
    pack(bundle, bundle.with_name("bundle.zip"), TOP, RELEASED)
    lacking = rf"{Path(name).name} is missing; nothing was sent"
    with pytest.raises(BundleError, match=lacking), seal(bundle):
        pass


@pytest.mark.parametrize("letter", ["\x1b", "\n", "\u202e"])
def test_a_line_that_a_terminal_would_act_on_is_refused(letter: str) -> None:
    named = {"person_or_org": {"name": f"Ada{letter}"}}
    body = json.dumps({"id": 1, "metadata": {"creators": [named]}}).encode()
    with pytest.raises(ReplyError, match="expected no control characters"):
        parse_response(JSON, body, Record)


@pytest.mark.parametrize("links", [None, {}, {"bucket": None}, {"latest_draft": "http://a"}])
def test_a_deposition_without_the_address_that_is_needed_says_so(links: Any) -> None:
    found = parse_response(JSON, json.dumps({"id": 3, "links": links}).encode(), Deposition)
    with pytest.raises(ReplyError, match=r"deposition 3 has no links\.bucket, expected an addr"):
        found.link("bucket")


@pytest.mark.parametrize(("status", "missing"), [(404, True), (410, True), (403, False)])
def test_only_what_the_archive_says_is_not_there_counts_as_missing(
    status: int, missing: bool
) -> None:
    def look() -> str:
        raise RefusedError("no", status)

    if missing:
        assert unless_missing(look) is None
    else:
        with pytest.raises(RefusedError):
            unless_missing(look)


def test_a_number_of_more_digits_than_python_writes_is_shown_in_words() -> None:
    assert short(10**5000) == "a number of thousands of digits"
    assert short([1] * 100) == repr([1] * 100)[:80]


@pytest.mark.parametrize("address", ["http://[::1", "http://[a]b/x"])
def test_what_is_no_address_is_not_asked(address: str) -> None:
    with (
        Transport(server_at(NOWHERE), Token(TOKEN)) as transport,
        pytest.raises(ArchiveError, match="which is no address; the token is for no other host"),
    ):
        transport.tell("GET", address)


def test_a_deadline_that_passes_with_no_connection_open_ends_nothing() -> None:
    with Deadline(0.001) as _:
        pass  # nothing was asked: no timer to stop
    deadline = Deadline(0.001)
    with deadline:
        deadline.watch("http11.receive_response_headers.started", {})
        timer = deadline._timer
        assert timer is not None
        timer.join(10)
        assert deadline.passed
    assert deadline._timer is None
