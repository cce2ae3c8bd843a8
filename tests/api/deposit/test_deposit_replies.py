"""The archive may answer anything: each answer ends in one sentence, and none takes the memory."""

from __future__ import annotations

import gzip
import json
import os
import tracemalloc
from contextlib import suppress
from pathlib import Path

import httpx
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from api.cli.command_line import app
from api.deposit.archives.contract import ArchiveError, UnreachableError
from api.deposit.archives.refusals import reasons
from api.deposit.archives.replies import Deposition, DepositionFiles, Entries, Record
from api.deposit.archives.responses import LARGEST, ReplyError, parse_response, read_response
from tests.api.deposit.conftest import only
from tests.api.deposit.standins.replies import bomb, drip, more_replies, of, replies, reply
from tests.api.deposit.standins.server import TOKEN

ROOT = Path(__file__).resolve().parents[3]
CASES = Path(os.environ.get("SUNATLAS_CASES", ROOT.parent / "shared" / "cases"))
ANSWERS = {**replies(), **more_replies()}
#: What the records interface does not read, and takes for a draft that is then not there.
UNREAD = {"a bucket whose address is none", "a bucket that is a number", "links that are a list"}


def in_one_sentence(error: BaseException) -> bool:
    said = str(error)
    return said.isprintable() and 10 < len(said) <= 600 and TOKEN not in said


@pytest.mark.parametrize(
    ("journey", "name"),
    [
        pytest.param(api, name, marks=pytest.mark.slow if api == "legacy" else ())
        for name, answer in ANSWERS.items()
        if answer is not drip
        for api in ("records", "legacy")
    ],
    indirect=["journey"],
)
def test_any_answer_ends_in_one_sentence_and_nothing_is_sent(journey, name):
    journey.fails(ANSWERS[name], "create", times=99)
    with pytest.raises(ArchiveError) as raised:
        journey.upload()
    assert in_one_sentence(raised.value), str(raised.value)
    assert not journey.sent()
    assert (" 404 " in str(raised.value)) == (name in UNREAD and journey.api == "records")


@pytest.mark.parametrize("step", ["list", "publish"])
@pytest.mark.parametrize("name", ["no member at all", "300 MB of zeros in gzip", "a list", "null"])
def test_later_steps_read_as_strictly(journey, name, step):
    draft = journey.upload().draft.id
    journey.fails(ANSWERS[name], step, times=99)
    with pytest.raises(ArchiveError) as raised:
        journey.publish(draft)
    assert in_one_sentence(raised.value)
    assert not journey.archive.records


def test_a_server_that_drips_is_left_in_time(journey):
    journey.timeout = 0.2
    journey.fails(drip, "create", times=99)
    with pytest.raises(UnreachableError, match=r"no whole answer within 0\.2 s"):
        journey.upload()
    assert journey.pauses == []


def test_a_server_that_drips_its_headers_is_left_in_time(journey):
    journey.timeout = 0.2

    def slowly(send):
        import time

        for letter in b"HTTP/1.1 200 OK\r\n" + b"X: " + b"x" * 400:
            send(bytes([letter]))
            time.sleep(0.02)

    journey.fails(slowly, "create", times=99)
    with pytest.raises(UnreachableError, match=r"no whole answer within 0\.2 s"):
        journey.upload()


def streamed(body: bytes, **headers: str) -> httpx.Response:
    pieces = (body[at : at + 1000] for at in range(0, len(body), 1000))
    named = {name.replace("_", "-"): value for name, value in headers.items()}
    return httpx.Response(200, headers=named, content=pieces)


def test_a_bomb_is_unpacked_no_further_than_the_limit():
    packed = bomb()
    assert len(packed) < LARGEST
    tracemalloc.start()
    with pytest.raises(ReplyError, match="more than 4,194,304 bytes"):
        read_response(streamed(packed, Content_Encoding="gzip"))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 3 * LARGEST


@pytest.mark.parametrize("size", [0, 1, LARGEST - 1, LARGEST])
@pytest.mark.parametrize("packing", ["", "gzip"])
def test_what_is_within_the_limit_is_read_whole(size, packing):
    body = os.urandom(size // 2) + bytes(size - size // 2)
    sent = gzip.compress(body) if packing else body
    assert read_response(streamed(sent, Content_Encoding=packing)) == body


VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.integers(10**18, 10**60)
    | st.floats()
    | st.text(max_size=20),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(
            st.sampled_from(
                [
                    *("id", "links", "metadata", "creators", "pids", "entries", "key", "status"),
                    *("checksum", "person_or_org", "identifiers", "bucket", "doi", "submitted"),
                    *("filename", "errors", "message", "messages", "field", "name", "orcid"),
                ]
            )
            | st.text(max_size=5),
            inner,
            max_size=6,
        )
    ),
    max_leaves=20,
)


@given(VALUES, st.integers(0, 200))
@example({"id": 10**5000}, 0)
@settings(max_examples=200, deadline=None)
def test_any_json_whole_or_cut_is_read_or_refused_in_a_sentence(value, cut):
    import sys

    limit = sys.get_int_max_str_digits()
    sys.set_int_max_str_digits(0)
    try:
        body = json.dumps(value).encode()
    finally:
        sys.set_int_max_str_digits(limit)
    answer = httpx.Response(200, headers={"Content-Type": "application/json"})
    for expected in (Record, Entries, Deposition, DepositionFiles):
        for text in (body, body[: len(body) - cut]):
            with suppress(ReplyError):
                assert isinstance(parse_response(answer, text, expected), expected)
    assert isinstance(reasons(answer, body), str)


@only("records")
@given(body=st.binary(max_size=200), head=st.binary(max_size=40), status=st.integers(100, 599))
@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_any_bytes_end_in_one_sentence(journey, body, head, status):
    journey.archive.faults.clear()
    journey.bundle.with_name("bundle.drafts.json").unlink(missing_ok=True)
    journey.fails(reply(status, body) if status % 2 else head + body, "create", times=99)
    with pytest.raises(ArchiveError) as raised:
        journey.upload()
    assert in_one_sentence(raised.value), str(raised.value)


def test_a_file_that_is_listed_twice_is_not_taken_for_one(journey):
    draft = journey.upload().draft.id
    name = "key" if journey.api == "records" else "filename"
    listed = [{"id": n, name: "README.md", "status": "completed"} for n in (1, 2)]
    journey.fails(of({"entries": listed} if journey.api == "records" else listed), "list", 99)
    with pytest.raises(ReplyError, match=r"lists README\.md twice"):
        journey.publish(draft)


def test_an_answer_of_another_record_is_not_taken_for_this_one(journey):
    draft = journey.upload().draft.id
    document = {"id": 77, "links": {"bucket": f"{journey.archive.address}/api/files/b"}}
    journey.archive.faults.clear()
    fault = journey.fails(of(document), "list")
    fault.at = lambda method, path: method == "GET" and path.endswith((f"/{draft}", "/draft"))
    with pytest.raises(ReplyError, match=f"answered of record 77, expected {draft}"):
        journey.publish(draft)


def test_a_redirect_to_the_same_server_is_followed_where_something_is_looked_at(journey):
    draft = journey.upload().draft.id
    where = f"/api/records/{draft}/draft"
    if journey.api == "legacy":
        where = f"/api/deposit/depositions/{draft}"
    for place, times in ((where, 1), (f"{journey.archive.address}{where}", 1)):
        fault = journey.fails("redirect", "list", times, Location=place)
        fault.at = lambda method, path: method == "GET" and path == where
        assert journey.upload().draft.id == draft
        assert fault.times == 0
    fault.times = 99
    with pytest.raises(ArchiveError, match="redirects are not followed"):
        journey.upload()


@only("records")
def test_the_command_line_says_the_sentence_and_fails(journey, monkeypatch):
    monkeypatch.setenv("ARCHIVE_TOKEN", TOKEN)
    monkeypatch.setenv("NO_PROXY", "*")
    journey.fails(ANSWERS["200,000 arrays deep"], "create", times=99)
    command = ["deposit", "upload", "--bundle", journey.bundle, "--server", journey.archive.address]
    shown = CliRunner().invoke(app, [str(word) for word in command], catch_exceptions=False)
    assert shown.exit_code == 1
    assert shown.stderr.count("\n") == 1
    assert "recursion limit exceeded" in shown.stderr


def test_the_reviewed_answers_are_among_these():
    """Those of the review's own file, where it lies beside the checkout."""
    if not (CASES / "archive-replies.json").is_file():
        pytest.skip(f"no archive-replies.json in {CASES}; SUNATLAS_CASES names another directory")
    raised = json.loads((CASES / "archive-replies.json").read_text("utf-8"))
    known = {
        "[ nested 200,000 deep ]": ANSWERS["200,000 arrays deep"],
        "300 MB of zeros, compressed": ANSWERS["300 MB of zeros in gzip"],
    }
    assert len(raised) == 4
    ours = set(ANSWERS.values())
    for case in raised:
        headers = {name.replace("-", "_"): value for name, value in case.get("headers", {}).items()}
        body = case["body"]
        answer = known[body] if isinstance(body, str) else of(body, case["status"], **headers)
        assert answer in ours
