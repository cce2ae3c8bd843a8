"""Pictures of data sets: drawn once, by another process, and kept."""

from __future__ import annotations

from pathlib import Path

import pytest

from api import previews
from api.previews import Pictures, place
from benchmark import datasets
from benchmark.datasets.preview import preview_png


def test_every_data_set_s_picture_is_published_as_the_code_is_now() -> None:
    wanted = {previews.published_preview(name).name for name in datasets.names()}
    found = {path.name for path in previews.PUBLISHED.iterdir()}
    assert found == wanted, "renew them: python -m api.previews --publish"


def test_what_is_published_is_drawn_by_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(previews, "_drawn_beside", lambda *_: pytest.fail("was drawn"))
    monkeypatch.setattr(previews, "draw", lambda *_: pytest.fail("was drawn"))
    name = datasets.names()[0]
    assert Pictures(tmp_path).png(name) == previews.published_preview(name).read_bytes()
    assert not list(tmp_path.iterdir())


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
    assert previews.main(["--publish"]) == 0
    assert set(folder.iterdir()) == {kept, lacking}
    assert kept.read_bytes() == b"drawn before"
    assert lacking.read_bytes() == preview_png(datasets.get("qpd-single-aperture"))


@pytest.mark.slow
def test_another_process_draws_what_the_data_set_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(previews, "PUBLISHED", tmp_path / "nothing is published")
    name = datasets.names()[-1]
    assert Pictures(tmp_path).png(name) == preview_png(datasets.get(name))
    assert place(tmp_path, name).is_file()
