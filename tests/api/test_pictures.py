"""Pictures of data sets: drawn once, and published with the code."""

from __future__ import annotations

from pathlib import Path

import pytest

from api import previews
from benchmark import datasets
from benchmark.datasets.preview import preview_png


def test_every_data_set_s_picture_is_published_as_the_code_is_now() -> None:
    wanted = {previews.published_preview(name).name for name in datasets.names()}
    found = {path.name for path in previews.PUBLISHED.iterdir()}
    assert found == wanted, "renew them: python -m api.previews"


def test_publishing_draws_what_lacks_and_removes_what_is_of_other_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "published"
    monkeypatch.setattr(previews, "PUBLISHED", folder)
    monkeypatch.setattr(datasets, "names", lambda: ("psd-single-aperture", "qpd-single-aperture"))
    folder.mkdir()
    kept, lacking = map(previews.published_preview, datasets.names())
    kept.write_bytes(b"drawn before")
    (folder / "psd-single-aperture.0123456789abcdef.png").write_bytes(b"of other code")
    assert previews.main() == 0
    assert set(folder.iterdir()) == {kept, lacking}
    assert kept.read_bytes() == b"drawn before"
    assert lacking.read_bytes() == preview_png(datasets.get("qpd-single-aperture"))
    for path in folder.iterdir():
        path.unlink()
    assert previews.png.__wrapped__("qpd-single-aperture") == preview_png(
        datasets.get("qpd-single-aperture")
    )
