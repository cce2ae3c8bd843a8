"""Uploads into both stand-ins: whole, mended, gone on with, never twice and never public."""

import pytest

from api.deposit.archives.contract import ArchiveError, RefusedError, UnreachableError
from api.deposit.archives.transport import PAUSES
from api.deposit.archives.uploading import BundleError, ChecksumError
from tests.api.deposit import small_bundle
from tests.api.deposit.conftest import each
from tests.api.deposit.standins.server import TOKEN

#: Steps that a first upload takes, in both interfaces or one.
TAKEN = ("create", "list", "declare", "send", "commit")
UNDECIDED = [
    *(500, "drop before", "drop after"),
    *(pytest.param(status, marks=pytest.mark.slow) for status in (502, 503, 504)),
]


def test_an_upload_brings_every_file_once_and_publishes_nothing(journey):
    done = journey.upload()
    assert set(done.files.values()) == {"sent"}
    assert journey.archive.held(done.draft.id) == journey.wanted()
    assert set(journey.sent().values()) == {1}
    assert not journey.archive.records
    assert not journey.archive.calls("POST", "/actions/publish")
    assert len(journey.archive.drafts) == 1


def test_a_second_upload_of_the_same_bundle_sends_no_file(journey):
    first = journey.upload()
    again = journey.upload()
    assert again.draft.id == first.draft.id
    assert set(again.files.values()) == {"there already"}
    assert set(journey.sent().values()) == {1}


def test_only_what_changed_is_sent_again(journey):
    done = journey.upload()
    small_bundle.make(journey.bundle, readme="# another\n")
    again = journey.upload()
    changed = {name for name, state in again.files.items() if state == "sent"}
    assert changed == {"README.md", "sun-sensor-atlas-0.1.0.zip"}
    assert journey.archive.held(done.draft.id) == journey.wanted()


@pytest.mark.parametrize("kind", UNDECIDED)
@each(*TAKEN)
def test_a_moment_s_failure_is_survived(journey, kind, step):
    fault = journey.fails(kind, step)
    done = journey.upload()
    assert fault.met.is_set()
    assert journey.archive.held(done.draft.id) == journey.wanted()
    assert not journey.archive.records
    # What was lost while a file was sent may be sent once more, and no other file is.
    assert sorted(journey.sent().values()) in ([1, 1, 1, 1, 1], [1, 1, 1, 1, 2])
    assert journey.pauses in ([], [PAUSES[0]])


@each(*TAKEN)
def test_too_many_requests_are_waited_out_as_long_as_asked(journey, step):
    journey.fails(429, step, times=2, Retry_After="7")
    done = journey.upload()
    assert journey.pauses == [7.0, 7.0]
    assert journey.archive.held(done.draft.id) == journey.wanted()


def test_a_server_that_asks_for_hours_is_not_waited_for(journey):
    journey.fails(429, "create", times=9, Retry_After="7200")
    with pytest.raises(RefusedError, match="429"):
        journey.upload()
    assert journey.pauses == []
    assert len(journey.archive.asked) == 1


@pytest.mark.parametrize("kind", [401, 403, 409])
@each(*TAKEN)
def test_a_refusal_ends_the_upload_and_the_next_one_ends_it_well(journey, kind, step):
    journey.fails(kind, step)
    with pytest.raises(RefusedError, match=str(kind)) as refused:
        journey.upload()
    assert refused.value.status == kind
    assert TOKEN not in str(refused.value)
    assert journey.pauses == []
    done = journey.upload()
    assert journey.archive.held(done.draft.id) == journey.wanted()
    assert not journey.archive.records


@pytest.mark.parametrize("kind", [500, "drop before"])
def test_an_archive_that_stays_away_is_given_up(journey, kind):
    journey.fails(kind, "send", times=99)
    with pytest.raises((UnreachableError, RefusedError)):
        journey.upload()
    assert journey.pauses == list(PAUSES)
    assert not journey.archive.records


def test_a_file_with_a_wrong_checksum_is_sent_again(journey):
    journey.fails("wrong checksum", "send")
    done = journey.upload()
    assert journey.archive.held(done.draft.id) == journey.wanted()
    assert sorted(journey.sent().values()) == [1, 1, 1, 1, 2]


def test_a_checksum_that_stays_wrong_ends_the_upload(journey):
    journey.fails("wrong checksum", "send", times=99)
    with pytest.raises(ChecksumError, match="sent 3 times"):
        journey.upload()
    journey.archive.faults.clear()
    done = journey.upload()
    assert journey.archive.held(done.draft.id) == journey.wanted()


def test_a_draft_deleted_by_hand_is_replaced(journey):
    first = journey.upload()
    if journey.api == "records":
        journey.archive.drafts.pop(first.draft.id)
    else:
        journey.archive.all.pop(first.draft.id)
    again = journey.upload()
    assert again.draft.id != first.draft.id
    assert journey.archive.held(again.draft.id) == journey.wanted()


def test_files_of_others_in_a_draft_are_left_and_told(journey):
    done = journey.upload()
    files = (
        journey.archive.drafts[done.draft.id]["files"]
        if journey.api == "records"
        else journey.archive.all[done.draft.id]["files"]
    )
    files["notes.txt"] = {**files["README.md"], "id": "f-9"}
    again = journey.upload(draft=done.draft.id)
    assert again.remaining_files == ("notes.txt",)
    assert "notes.txt" in journey.archive.held(done.draft.id)
    with pytest.raises(ArchiveError, match=r"notes\.txt is not of the bundle"):
        journey.publish(done.draft.id)


def test_a_draft_that_is_not_there_is_not_gone_on_with(journey):
    with pytest.raises(ArchiveError, match="no unpublished draft 77"):
        journey.upload(draft="77")
    with pytest.raises(ArchiveError, match="is no identifier"):
        journey.upload(draft="../77")


def test_a_damaged_bundle_is_not_sent(journey):
    (journey.bundle / "README.md").write_text("other")
    with pytest.raises(BundleError, match=r"README\.md: SHA-256"):
        journey.upload()
    small_bundle.make(journey.bundle)
    packed = journey.bundle.with_name("bundle.zip")
    packed.write_bytes(packed.read_bytes()[:-30])
    with pytest.raises(BundleError, match=r"bundle\.zip"):
        journey.upload()
    assert journey.archive.asked == []


def test_a_zip_of_another_bundle_is_not_sent(journey):
    other = small_bundle.make(journey.bundle.with_name("other"), readme="other")
    other.with_name("other.zip").replace(journey.bundle.with_name("bundle.zip"))
    with pytest.raises(BundleError, match="not the zip of"):
        journey.upload()
    assert journey.archive.asked == []


@pytest.mark.parametrize("text", ["[]", "{", '{"x y": 3}', '{"a b": {"draft": 3}}'])
def test_a_memory_that_says_nothing_is_named(journey, text):
    path = journey.bundle.with_name("bundle.drafts.json")
    path.write_text(text)
    with pytest.raises(BundleError, match=r"bundle\.drafts\.json"):
        journey.upload()
    assert journey.archive.asked == []
