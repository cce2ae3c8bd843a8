"""Parts of a response: byte ranges as RFC 9110 has them, of files and of every other answer."""

from __future__ import annotations

from email import message_from_bytes

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.web.ranges import MOST_RANGES, ranges
from tests.api.conftest import Client

FILE = "/v1/datasets/cmos-single-aperture/errors.parquet"


@pytest.fixture(scope="module")
def whole(atlas: Client) -> bytes:
    return atlas.get(FILE).content


def test_a_download_that_was_cut_off_goes_on(atlas: Client, whole: bytes) -> None:
    etag = atlas.get(FILE).headers["etag"]
    rest = atlas.get(FILE, headers={"Range": "bytes=1000-", "If-Range": etag})
    assert (rest.status_code, whole[:1000] + rest.content) == (206, whole)
    assert rest.headers["content-range"] == f"bytes 1000-{len(whole) - 1}/{len(whole)}"
    assert rest.headers["etag"] == etag
    renewed = atlas.get(FILE, headers={"Range": "bytes=1000-", "If-Range": '"of another release"'})
    assert (renewed.status_code, renewed.content) == (200, whole), "parts of two files do not mix"


def test_several_ranges_come_as_parts_that_a_mail_reader_understands(
    atlas: Client, whole: bytes
) -> None:
    answer = atlas.get(FILE, headers={"Range": "bytes=0-3, 10-19, -4"})
    assert (answer.status_code, answer.headers["accept-ranges"]) == (206, "bytes")
    assert int(answer.headers["content-length"]) == len(answer.content)
    kind = f"Content-Type: {answer.headers['content-type']}\r\n\r\n".encode()
    _, *parts = message_from_bytes(kind + answer.content).walk()
    ends = [(0, 3), (10, 19), (len(whole) - 4, len(whole) - 1)]
    stated = [f"bytes {first}-{last}/{len(whole)}" for first, last in ends]
    assert [part["Content-Range"] for part in parts] == stated
    for first, last in ends:
        assert b"\r\n\r\n" + whole[first : last + 1] + b"\r\n--" in answer.content
    assert answer.content.count(b"PAR1") == 2, "how a file of Parquet begins and ends"


def test_what_means_nothing_is_ignored_and_what_lies_behind_the_end_is_refused(
    atlas: Client, whole: bytes
) -> None:
    for asked in ("bytes=a-b", "rows=0-1", "bytes=5-2", "bytes=-", "bytes=0-,0-"):
        answer = atlas.get(FILE, headers={"Range": asked})
        assert (answer.status_code, answer.content) == (200, whole), asked
    refused = atlas.get(FILE, headers={"Range": f"bytes={len(whole)}-"})
    assert (refused.status_code, refused.content) == (416, b"")
    assert refused.headers["content-range"] == f"bytes */{len(whole)}"


def test_a_range_counts_the_bytes_of_a_table_and_not_of_its_compression(atlas: Client) -> None:
    address = "/v1/leaderboard?format=csv"
    table = atlas.get(address, headers={"Accept-Encoding": "identity"})
    part = atlas.get(address, headers={"Accept-Encoding": "gzip", "Range": "bytes=0-999"})
    assert "content-encoding" not in part.headers
    assert part.content == table.content[:1000]
    assert part.headers["etag"] == table.headers["etag"]
    head = atlas.request("HEAD", address, headers={"Range": "bytes=0-999"})
    assert head.status_code == 200, "a range is of what is sent"


@given(st.integers(0, 50), st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), min_size=1))
def test_ranges_are_the_positions_that_a_slice_takes(
    size: int, ends: list[tuple[int, int]]
) -> None:
    asked = [f"{min(pair)}-{max(pair)}" for pair in ends]
    taken = [range(size)[min(pair) : max(pair) + 1] for pair in ends]
    is_sane = sum(map(len, taken)) <= size and len(ends) <= MOST_RANGES
    expected = [positions for positions in taken if positions] if is_sane else None
    assert ranges("bytes=" + ",".join(asked), size) == expected
