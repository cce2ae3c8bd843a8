"""Forms with files are read part by part, or refused with what was expected."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import partial

import pytest
from starlette.types import Message

from api.service import calibrations as service
from api.service.problems import Problem
from api.web import calibrations, requests
from api.web.calibrations import sent
from api.web.requests import StrictRequest
from calibrate.uploaded import Upload

FIELD = b'Content-Disposition: form-data; name="%s"\r\n\r\n%s'
FILE = b'Content-Disposition: form-data; name="file"; filename="%s"\r\n\r\n%s'


def form_of(chunks: Iterable[bytes], **headers: str) -> tuple[dict[str, str], tuple[Upload, ...]]:
    """Read a form that arrives in chunks; names of headers have _ for -."""
    named = {"content_type": "multipart/form-data; boundary=a", **headers}
    scope = {
        "type": "http",
        "headers": [(k.replace("_", "-").encode(), v.encode()) for k, v in named.items()],
    }
    waiting: Iterator[bytes] = iter(chunks)

    async def receive() -> Message:
        chunk = next(waiting, None)
        return {"type": "http.request", "body": chunk or b"", "more_body": chunk is not None}

    return asyncio.run(sent(StrictRequest(scope, receive)))


def body(*parts: bytes) -> bytes:
    return b"".join(b"--a\r\n" + part + b"\r\n" for part in parts) + b"--a--\r\n"


def test_fields_and_files_are_told_apart_whatever_else_stands_in_a_head() -> None:
    """A field for files that was left empty (no name, no content) is no file."""
    typed = b"Content-Type: text/csv\r\n" + FILE % (b"b.csv", b"1,2\r\n3,4")
    whole = body(FIELD % (b"apply", b"true"), typed, FILE % (b"", b""))
    form = form_of(whole[at : at + 7] for at in range(0, len(whole), 7))
    assert form == ({"apply": "true"}, (Upload("b.csv", b"1,2\r\n3,4"),))


@pytest.mark.parametrize(
    ("whole", "reason"),
    [
        (body(b"no end of the head"), "Found invalid character"),
        (body(b"Content-Type: text/csv\r\n\r\n1,2"), '"name" must be provided'),
        (body(b"Content-Disposition: form-data\r\n\r\n1,2"), '"name" must be provided'),
        (
            body(FIELD % (b"apply", b"true"), FIELD % (b"apply", b"false")),
            "field apply stands twic",
        ),
        (body(*(FIELD % (b"f%d" % n, b"") for n in range(41))), "number of fields is 40"),
        (body(*[FILE % (b"a", b"1")] * 41), "number of files is 40"),
        (body(FIELD % (b'apply"' + 50 * b";", b"true")), "more than 50 semicolons"),
        (body(FIELD % (b"config", b"#" * 100_001)), "maximum size"),
        (b"before" + body(FIELD % (b"apply", b"true")), "Expected boundary"),
        (body(FILE % (b"a", b"1"))[:-8], "no boundary ends it"),
        (b"", "no boundary ends it"),
    ],
)
def test_a_body_that_is_no_form_is_refused_with_the_reason(whole: bytes, reason: str) -> None:
    with pytest.raises(Problem) as refused:
        form_of([whole])
    assert (refused.value.status_code, refused.value.detail.count(reason)) == (400, 1)


def test_forty_parts_are_taken() -> None:
    fields, files = form_of([body(*(FIELD % (b"f%d" % n, b"") for n in range(40)))])
    assert (len(fields), files) == (40, ())
    name = 48 * b";" + b".csv"
    assert form_of([body(FILE % (name, b"1"))]) == ({}, (Upload(name.decode(), b"1"),))


def test_memory_of_a_form_goes_back_to_the_system_read_or_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    released: list[bytes] = []
    monkeypatch.setattr(calibrations, "_REST_S", 0.0)
    for whole in (body(FILE % (b"b.csv", b"1")), b"no form"):
        monkeypatch.setattr(calibrations, "release_free_memory", partial(released.append, whole))
        with suppress(Problem):
            form_of([whole])
    assert released == [body(FILE % (b"b.csv", b"1")), b"no form"]


@pytest.mark.parametrize("coding", ["gzip", "br, identity"])
def test_a_packed_body_is_refused_by_its_coding(coding: str) -> None:
    with pytest.raises(Problem) as refused:
        form_of([body(FIELD % (b"apply", b"true"))], content_encoding=coding)
    assert refused.value.status_code == 415
    assert coding in refused.value.detail
    assert "identity" in refused.value.detail


def test_a_long_content_type_is_refused_unparsed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parsing took the square of its length: 6 s for 100 kB, in which nobody was answered."""
    monkeypatch.setattr(requests, "parse_options_header", lambda _: pytest.fail("it is parsed"))
    with pytest.raises(Problem) as refused:
        form_of([b""], content_type="multipart/form-data; boundary=a" + 500 * ";")
    assert refused.value.status_code == 415
    assert "in at most 500 characters" in refused.value.detail


def test_a_body_without_an_end_is_read_no_further_than_the_limit(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(requests, "LARGEST_FORM", 400)
    read = 0

    def endless() -> Iterator[bytes]:
        nonlocal read
        yield b"--a\r\n" + FILE % (b"b.csv", b"")
        while True:
            read += 50
            yield bytes(50)

    with pytest.raises(Problem) as refused:
        form_of(endless())
    assert refused.value.status_code == 413
    assert "at most 400 bytes" in refused.value.detail
    assert read <= 450, "one chunk beyond the limit"


def test_bodies_are_read_in_turn_and_who_waits_is_not_called_slow(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """400 files of 9.9 MB that arrived at once kept pages waiting for 82 ms."""
    monkeypatch.setattr(requests, "MOST_PER_S", 1000)
    monkeypatch.setattr(requests, "PATIENCE_S", 0.1)
    monkeypatch.setattr(requests, "SLOWEST_PER_S", 10**9)
    monkeypatch.setattr(requests, "_read_through", 0.0)
    whole = body(FILE % (b"b.csv", b"1" * 400))
    begun = time.monotonic()
    for _ in range(2):
        form_of([whole[:200], whole[200:]])
    assert time.monotonic() - begun > (2 * len(whole) - 300) / 1000


def test_so_many_forms_arrive_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(service, "MOST_ARRIVING", 0)
    with pytest.raises(Problem) as refused:
        form_of([body(FIELD % (b"apply", b"true"))])
    assert (refused.value.status_code, refused.value.headers) == (503, {"Retry-After": "10"})
    monkeypatch.setattr(service, "MOST_ARRIVING", 1)
    assert form_of([body(FIELD % (b"apply", b"true"))]) == ({"apply": "true"}, ())
