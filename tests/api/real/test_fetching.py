"""A public set is fetched by address and checksum, and never half-written."""

from __future__ import annotations

import dataclasses
import hashlib
import http.client
import io
from pathlib import Path
from urllib.error import URLError

import numpy as np
import pytest

from api.real import fetching
from api.real.fetching import FetchError, fetch
from api.real.sets import SETS, Block, RealSet, Source

NUMBERS = np.arange(12.0).reshape(3, 4) / 7.0
DATA = b"head" + NUMBERS.astype("<f8").tobytes() + b"tail"
STAND_IN = RealSet(
    "stand-in", "Made up.", "https://example.org/v1/", "MIT", "Nobody, 2026",
    (
        Source(
            "a.jld2", hashlib.sha256(DATA).hexdigest(), "run1.csv",
            (Block(("a", "b"), 4, 4), Block(("c",), 4 + 64, 4)),
        ),
        Source("LICENSE", hashlib.sha256(b"MIT License").hexdigest(), "LICENSE"),
    ),
)  # fmt: skip
HELD = {"https://example.org/v1/a.jld2": DATA, "https://example.org/v1/LICENSE": b"MIT License"}
SHARED = Path(__file__).parents[4] / "shared" / "real"


def test_files_are_converted_to_the_last_bit_with_licence_and_citation(tmp_path):
    written = fetch(STAND_IN, tmp_path / "out", HELD.__getitem__)
    assert {path.name for path in written} == {"run1.csv", "LICENSE", "CITATION.txt"}
    table = np.loadtxt(tmp_path / "out" / "run1.csv", delimiter=",", skiprows=1)
    assert np.array_equal(table, NUMBERS.T)
    said = (tmp_path / "out" / "CITATION.txt").read_text()
    assert "Nobody, 2026" in said
    assert "MIT" in said


def test_another_file_than_the_known_one_is_refused_and_nothing_written(tmp_path):
    with pytest.raises(FetchError, match="expected SHA-256"):
        fetch(STAND_IN, tmp_path / "out", lambda address: HELD[address] + b" ")
    assert not (tmp_path / "out").exists()


@pytest.mark.skipif(not SHARED.is_dir(), reason="no ../shared beside this checkout")
def test_the_runs_of_the_box_are_those_that_lie_here():
    """Bytes made of the converted runs, laid where the originals have them, give them back."""
    runs = [source for source in SETS["cubesatbox"].sources if source.blocks]
    assert [source.written for source in runs] == sorted(
        path.name for path in (SHARED / "cubesatbox").glob("*.csv")
    )
    first = runs[0]
    table = np.loadtxt(SHARED / "cubesatbox" / first.written, delimiter=",", skiprows=1)
    columns = [column for block in first.blocks for column in block.columns]
    header = (SHARED / "cubesatbox" / first.written).read_text().splitlines()[0]
    assert header.split(",") == columns
    assert len(table) == first.blocks[0].rows


@pytest.mark.parametrize(
    ("reply", "said"),
    [
        (io.BytesIO(b"x" * 11), "at most 10 bytes"),
        (URLError("no route"), "no route"),
        (http.client.IncompleteRead(b""), "IncompleteRead"),
    ],
)
def test_an_answer_that_is_too_long_or_none_is_refused(reply, said, monkeypatch, tmp_path):
    def urlopen(request, timeout):
        if isinstance(reply, Exception):
            raise reply
        return reply

    monkeypatch.setattr(fetching, "urlopen", urlopen)
    monkeypatch.setattr(fetching, "_LARGEST", 10)
    with pytest.raises(FetchError, match=said):
        fetch(STAND_IN, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_only_what_is_sent_under_https_is_fetched(monkeypatch, tmp_path):
    def urlopen(request, timeout):
        return io.BytesIO(HELD[request.full_url])

    monkeypatch.setattr(fetching, "urlopen", urlopen)
    assert len(fetch(STAND_IN, tmp_path / "out")) == 3
    plain = dataclasses.replace(STAND_IN, address="http://example.org/v1/")
    with pytest.raises(FetchError, match="expected an address of https"):
        fetch(plain, tmp_path / "other")
