"""Parts of a response: byte ranges as RFC 9110 has them, of files and of every other answer."""

from __future__ import annotations

import io
from email import message_from_bytes

import pytest
from hypothesis import given
from hypothesis import strategies as st

from api.web.ranges import MOST_RANGES, ranges
from tests.api.conftest import Client

FILE = "/v1/datasets/cmos-single-aperture/errors.parquet"


@pytest.fixture(scope="module")
def whole(atlas: Client) -> bytes:
    answer = atlas.get(FILE)
    assert answer.headers["accept-ranges"] == "bytes"
    return answer.content


def test_a_download_that_was_cut_off_goes_on(atlas: Client, whole: bytes) -> None:
    etag = atlas.get(FILE).headers["etag"]
    rest = atlas.get(FILE, headers={"Range": "bytes=1000-", "If-Range": etag})
    assert rest.status_code == 206
    assert whole[:1000] + rest.content == whole
    assert rest.headers["content-range"] == f"bytes 1000-{len(whole) - 1}/{len(whole)}"
    assert rest.headers["content-length"] == str(len(whole) - 1000)
    assert rest.headers["etag"] == etag
    renewed = atlas.get(FILE, headers={"Range": "bytes=1000-", "If-Range": '"of another release"'})
    assert (renewed.status_code, renewed.content) == (200, whole), "parts of two files do not mix"


def test_several_ranges_come_as_parts_that_a_mail_reader_understands(
    atlas: Client, whole: bytes
) -> None:
    answer = atlas.get(FILE, headers={"Range": "bytes=0-3, 10-19, -8"})
    assert answer.status_code == 206
    assert int(answer.headers["content-length"]) == len(answer.content)
    kind = f"Content-Type: {answer.headers['content-type']}\r\n\r\n".encode()
    parts = list(message_from_bytes(kind + answer.content).walk())[1:]
    size = len(whole)
    assert [part["Content-Range"] for part in parts] == [
        f"bytes 0-3/{size}", f"bytes 10-19/{size}", f"bytes {size - 8}-{size - 1}/{size}"
    ]  # fmt: skip
    assert b"PAR1" in answer.content
    for taken in (whole[:4], whole[10:20], whole[-8:]):
        assert b"\r\n\r\n" + taken + b"\r\n--" in answer.content


def test_the_end_of_a_parquet_file_is_read_alone(atlas: Client, whole: bytes) -> None:
    foot = atlas.get(FILE, headers={"Range": "bytes=-8"}).content
    assert foot[4:] == b"PAR1"
    length = int.from_bytes(foot[:4], "little") + 8
    end = atlas.get(FILE, headers={"Range": f"bytes=-{length}"}).content
    assert end == whole[-length:]
    pyarrow = pytest.importorskip("pyarrow.parquet")
    assert pyarrow.read_metadata(io.BytesIO(whole)).num_rows > 0


@pytest.mark.parametrize("asked", ["bytes=a-b", "rows=0-1", "bytes=5-2", "bytes=-", "bytes=0-,0-"])
def test_a_range_that_means_nothing_is_ignored(atlas: Client, whole: bytes, asked: str) -> None:
    answer = atlas.get(FILE, headers={"Range": asked})
    assert (answer.status_code, answer.content) == (200, whole)


def test_a_range_behind_the_end_is_refused_with_the_length(atlas: Client, whole: bytes) -> None:
    answer = atlas.get(FILE, headers={"Range": f"bytes={len(whole)}-"})
    assert (answer.status_code, answer.content) == (416, b"")
    assert answer.headers["content-range"] == f"bytes */{len(whole)}"


def test_a_range_counts_the_bytes_of_a_table_and_not_of_its_compression(atlas: Client) -> None:
    address = "/v1/leaderboard?format=csv"
    table = atlas.get(address, headers={"Accept-Encoding": "identity"})
    part = atlas.get(address, headers={"Accept-Encoding": "gzip", "Range": "bytes=0-999"})
    assert "content-encoding" not in part.headers
    assert part.content == table.content[:1000]
    assert part.headers["etag"] == table.headers["etag"]
    head = atlas.request("HEAD", address, headers={"Range": "bytes=0-999"})
    assert head.status_code == 200, "a range is of what is sent"


@given(
    size=st.integers(0, 50),
    wanted=st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), min_size=1, max_size=4),
)
def test_ranges_are_the_positions_that_a_slice_takes(
    size: int, wanted: list[tuple[int, int]]
) -> None:
    pairs = [(min(pair), max(pair)) for pair in wanted]
    content = range(size)
    expected = [content[first : last + 1] for first, last in pairs if content[first : last + 1]]
    found = ranges("bytes=" + ",".join(f"{first}-{last}" for first, last in pairs), size)
    assert found == (expected if sum(map(len, expected)) <= size else None)
    assert ranges("bytes=" + ",".join(["0-0"] * (MOST_RANGES + 1)), 1000) is None
