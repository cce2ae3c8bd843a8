"""Results of stages on disk: the last bit comes back, the damaged does not, and room is made."""

import os

import numpy as np
import pytest

from benchmark.datasets.samples import Samples
from benchmark.results.stage_files import LIMIT_GB, StageFiles, limit_bytes

LIMIT = 10**6


@pytest.fixture
def files(tmp_path):
    return StageFiles(tmp_path / "stages", LIMIT)


def key(number):
    return f"{number:02d}" * 20


@pytest.mark.parametrize(
    "array",
    [
        np.arange(24, dtype=np.uint16).reshape(2, 3, 4),
        np.asfortranarray(np.arange(24.0).reshape(4, 6)),
        np.array([0.0, -0.0, np.nan, np.inf, 5e-324]),
        np.array([True, False]),
        np.empty((3, 0)),
        np.array(1.5),
        np.arange(3, dtype=">i8"),
    ],
)
def test_an_array_comes_back_to_the_last_bit_in_the_order_it_had(files, array):
    samples = Samples(array, np.eye(3), None, {"time_s": array})
    files.put(key(1), {"test": samples})
    found = files.get(key(1))["test"]
    for one in (found.observations, found.context["time_s"]):
        assert one.dtype == array.dtype
        assert one.size == 0 or one.strides == array.strides
        assert one.tobytes("A") == array.tobytes("A")
        assert one.flags.writeable == array.flags.writeable


def test_what_would_come_back_otherwise_is_not_kept(files):
    files.put(key(1), np.arange(24).reshape(4, 6)[:, ::2])
    files.put(key(2), lambda: 1)
    assert files.keys() == set()
    assert files.get(key(1)) is None


def test_a_damaged_file_is_as_one_that_is_not_there(files):
    files.put(key(1), np.arange(1000))
    (path,) = files.directory.glob("01/*")
    whole = path.read_bytes()
    for damaged in (b"", whole[:-1], whole[:40], whole[:50] + b"x" + whole[51:]):
        path.write_bytes(damaged)
        assert files.get(key(1)) is None
    path.write_bytes(whole)
    assert files.get(key(1)).tolist() == list(range(1000))


def test_what_was_used_longest_ago_goes_first(files, tmp_path):
    rng = np.random.default_rng(1)
    for number in range(3):
        files.put(key(number), rng.random(5000))
        (path,) = files.directory.glob(f"{key(number)[:2]}/*")
        os.utime(path, (number, number))
    assert files.get(key(0)) is not None  # used just now
    StageFiles(tmp_path / "stages", 90_000).make_room()
    assert files.keys() == {key(0), key(2)}


def test_the_limit_is_kept_while_results_come(tmp_path):
    files = StageFiles(tmp_path, 200_000)
    rng = np.random.default_rng(1)
    for number in range(30):
        files.put(key(number), rng.random(3000))
        assert files.size() < 250_000
    assert 0 < len(files.keys()) < 10
    files.put(key(99), rng.random(100_000))
    assert files.get(key(99)) is None, "larger than all there may be"


def test_what_else_is_in_the_folder_is_neither_counted_nor_removed(files):
    files.put(key(1), np.arange(1000))
    (files.directory / "elsewhere").mkdir()
    others = [files.directory / name for name in ("room", "01/.half", "elsewhere/x")]
    for path in others:
        path.write_bytes(b"0" * 100)
    assert files.keys() == {key(1)}
    (path,) = files.directory.glob("01/[!.]*")
    assert files.size() == path.stat().st_size
    StageFiles(files.directory, 1).make_room()
    assert files.keys() == set()
    assert all(path.is_file() for path in others)


def test_the_limit_is_a_setting(monkeypatch, tmp_path):
    monkeypatch.delenv(LIMIT_GB, raising=False)
    assert limit_bytes() == 4 * 2**30
    monkeypatch.setenv(LIMIT_GB, "0.5")
    assert limit_bytes() == 2**29
    for wrong in ("much", "-1", "nan", "inf"):
        monkeypatch.setenv(LIMIT_GB, wrong)
        with pytest.raises(ValueError, match=f"{LIMIT_GB} must be a number"):
            limit_bytes()
    files = StageFiles(tmp_path / "none", 0)
    files.put(key(1), 1)
    assert not files.directory.exists()
