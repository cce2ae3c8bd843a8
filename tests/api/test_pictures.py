"""Pictures of data sets: drawn once, by another process, and kept."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from api import pictures
from api.pictures import Pictures, place
from benchmark import datasets
from benchmark.datasets.preview import preview_png


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What was drawn beside, each in a moment; a store that is a file takes nothing."""
    names: list[str] = []

    def draw(directory: Path, name: str) -> None:
        names.append(name)
        if not directory.is_file():
            path = place(directory, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(name.encode())

    monkeypatch.setattr(pictures, "_drawn_beside", draw)
    return names


def test_another_process_draws_what_the_data_set_draws(tmp_path: Path) -> None:
    name = datasets.names()[-1]
    assert Pictures(tmp_path).png(name) == preview_png(datasets.get(name))
    assert place(tmp_path, name).is_file()


def test_many_who_ask_at_once_have_it_drawn_once(tmp_path: Path, drawn: list[str]) -> None:
    shared = Pictures(tmp_path)
    found: list[bytes] = []
    threads = [threading.Thread(target=lambda: found.append(shared.png("a"))) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [b"a"] * 8
    assert drawn == ["a"]
    assert Pictures(tmp_path).png("a") == b"a"
    assert drawn == ["a"]


def test_a_store_that_takes_nothing_is_done_without(tmp_path: Path, drawn: list[str]) -> None:
    store = tmp_path / "store"
    store.write_text("no directory")
    assert Pictures(store).png("a") == b"a"
    assert Pictures(None).png("b") == b"b"
    assert drawn == ["a", "a", "b"]


def test_what_is_not_drawn_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pictures, "_drawn_beside", lambda *_: None)
    with pytest.raises(RuntimeError, match="the picture of a was not drawn"):
        Pictures(tmp_path).png("a")


def test_pictures_of_older_code_are_removed_but_the_newest(tmp_path: Path) -> None:

    for number in range(6):
        folder = tmp_path / pictures.FOLDER / f"older{number}"
        folder.mkdir(parents=True)
        os.utime(folder, (number, number))
    place(tmp_path, "a").parent.mkdir()
    pictures.forget_others(tmp_path)
    left = {found.name for found in (tmp_path / pictures.FOLDER).iterdir()}
    assert left == {"older3", "older4", "older5", pictures.digest()}
