"""Sources that were looked at serve again as long as nothing has changed, and no longer."""

from __future__ import annotations

import itertools
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from benchmark.results import closure
from benchmark.results.closure import Sources, closure_digest

Write = Callable[[str, str], None]
ENTRY = "sources_pkg.inner.entry:f"


@pytest.fixture
def write(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Write:
    """Writes modules of a package that is taken for one of ours."""
    monkeypatch.setattr(closure, "FIRST_PARTY", ("sources_pkg",))
    monkeypatch.setattr(Sources, "_last", None)
    monkeypatch.syspath_prepend(tmp_path)
    times = itertools.count(10**18, 10**9)

    def to(name: str, content: str) -> None:
        path = tmp_path / "sources_pkg" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content)
        # two writes within one tick of the file system's clock would have one time
        os.utime(path, ns=(next(times), next(times)))

    to("__init__.py", "")
    to("inner/__init__.py", "")
    to("inner/entry.py", "from sources_pkg import other\n\ndef f():\n    return other.g\n")
    to("other.py", "g = 1\n")
    return to


def test_unchanged_sources_are_looked_at_once(
    write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = closure_digest(ENTRY)
    first = Sources.as_they_are()
    monkeypatch.setattr(Sources, "walk", lambda *_: pytest.fail("walked again"))
    assert closure_digest(ENTRY) == found
    assert Sources.as_they_are() is first


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("other.py", "g = 2\n"),  # of as many bytes
        ("inner/entry.py", "def f():\n    return 3\n"),
        ("other/__init__.py", "g = 4\n"),  # a package hides the module
    ],
)
def test_a_change_or_a_new_module_is_seen(write: Write, name: str, content: str) -> None:
    before = closure_digest(ENTRY)
    first = Sources.as_they_are()
    write(name, content)
    assert closure_digest(ENTRY) == Sources().digest(ENTRY) != before
    assert Sources.as_they_are() is not first


def test_a_file_that_has_gone_is_seen(write: Write, tmp_path: Path) -> None:
    before = closure_digest(ENTRY)
    (tmp_path / "sources_pkg" / "other.py").unlink()
    assert closure_digest(ENTRY) == Sources().digest(ENTRY) != before


def test_others_do_not_learn_of_plugged_in_packages(write: Write, tmp_path: Path) -> None:
    """What is first party for a plug-in is so for no other: the order of asking tells nothing."""
    (tmp_path / "plugged.py").write_text("def g():\n    return 1\n")
    (tmp_path / "second.py").write_text("from plugged import g\n\ndef h():\n    return g()\n")
    write("user.py", "def u():\n    from plugged import g\n    return g()\n")
    entries = "plugged:g", "second:h", "sources_pkg.user:u", ENTRY
    fresh = [Sources().digest(entry) for entry in entries]
    kept = Sources.as_they_are()
    for order in (entries, entries[::-1]):
        found = {entry: kept.digest(entry) for entry in order}
        assert [found[entry] for entry in entries] == fresh
    assert Sources.as_they_are() is kept


def test_another_search_path_is_another_tree(
    write: Write, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before, first = closure_digest(ENTRY), Sources.as_they_are()
    monkeypatch.syspath_prepend(os.fspath(tmp_path / "elsewhere"))
    assert Sources.as_they_are() is not first
    assert closure_digest(ENTRY) == before
