"""Files of an export, part by part: archives of the same bytes, tables."""

from __future__ import annotations

import stat
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmark.datasets.export import ExportError, export
from benchmark.datasets.export_arrays import columns_of, read_archive, write_archive, write_table
from benchmark.datasets.export_verification import verify

ARRAYS = {
    "observations": np.arange(8.0).reshape(2, 4) / 3,
    "sun": np.array([[0.0, 0.6, 0.8], [0.1, 0.2, 0.3]]),
    "origin_px": np.array([[1, 2], [3, 4]]),
    "observable": np.array([True, False]),
    "bound_deg": np.array([0.5, np.inf]),
}


def test_an_archive_is_the_same_bytes_readable_by_all(tmp_path: Path) -> None:
    write_archive(tmp_path / "a.npz", ARRAYS)
    write_archive(tmp_path / "b.npz", ARRAYS)
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.npz") as archive:
        assert [entry.filename for entry in archive.infolist()] == [f"{n}.npy" for n in ARRAYS]
        for entry in archive.infolist():
            assert entry.date_time == (1980, 1, 1, 0, 0, 0)
            assert entry.create_system == 3
            mode = entry.external_attr >> 16
            assert stat.S_ISREG(mode)
            assert stat.S_IMODE(mode) == 0o644
            assert entry.compress_type == zipfile.ZIP_DEFLATED
    found = read_archive(tmp_path / "a.npz")
    assert list(found) == list(ARRAYS)
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found[name], array, strict=True)
    (tmp_path / "c.npz").write_text("no archive")
    with pytest.raises(ValueError, match=r"c\.npz: not an archive of arrays"):
        read_archive(tmp_path / "c.npz")


def test_columns_are_numbered_from_one_or_named_by_axis(tmp_path: Path) -> None:
    found = columns_of(ARRAYS)
    assert list(found) == [
        "signal_1", "signal_2", "signal_3", "signal_4", "sun_x", "sun_y", "sun_z",
        "origin_px_1", "origin_px_2", "observable", "bound_deg",
    ]  # fmt: skip
    np.testing.assert_array_equal(found["signal_2"], ARRAYS["observations"][:, 1])
    np.testing.assert_array_equal(found["sun_z"], ARRAYS["sun"][:, 2])
    # three signals are signals, no vector
    three = columns_of({"observations": np.zeros((2, 3))})
    assert list(three) == ["signal_1", "signal_2", "signal_3"]
    write_table(tmp_path / "t.csv", ARRAYS)
    header, first, second = (tmp_path / "t.csv").read_text().splitlines()
    assert header.split(",") == list(found)
    assert first.split(",")[:2] == ["0.0", "0.3333333333333333"]
    assert second.split(",")[-2:] == ["False", "inf"]


@pytest.mark.parametrize("n", [0, -1])
def test_an_export_is_of_one_sample_at_least(tmp_path: Path, n: int) -> None:
    with pytest.raises(ValueError, match=rf"^n\b.*\b1\b.* {n}$"):
        export("pd-maskless-cube", tmp_path / "out", n=n)
    assert list(tmp_path.iterdir()) == []


def test_an_export_of_one_sample_of_one_split_has_it_in_every_form(tmp_path: Path) -> None:
    seen: list[Any] = []
    made = export(
        "pd-maskless-cube",
        tmp_path / "out",
        conditions=["nominal"],
        splits=["test"],
        n=1,
        progress=lambda *said: seen.append(said),
    )
    assert seen == [(0, 1, "nominal test"), (1, 1, "")]
    assert made.card["exported"] == {
        "conditions": ["nominal"], "splits": ["test"], "first_samples": 1,
    }  # fmt: skip
    arrays = read_archive(tmp_path / "out" / "nominal" / "test.npz")
    assert {len(array) for array in arrays.values()} == {1}
    assert len((tmp_path / "out" / "nominal" / "test.csv").read_text().splitlines()) == 2
    assert verify(tmp_path / "out") == []
    with pytest.raises(ExportError, match="replace it with --force"):
        export("pd-maskless-cube", tmp_path / "out", n=1)
