"""The guide where something is missing or fails: pages, builders, a file that cannot be written."""

from __future__ import annotations

from pathlib import Path

import pytest

from api.docs.blocks import rerun
from api.guide import site
from api.guide.site import GuideError
from tests.api.docs.test_guide_blocks import fenced, page


@pytest.fixture
def pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    directory = tmp_path / "docs"
    directory.mkdir()
    (directory / "index.md").write_text("# One\n")
    monkeypatch.setattr(site, "source", lambda: directory)
    return directory


def test_pages_that_sphinx_refuses_leave_nothing_behind(
    pages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(site, "_settings", lambda: {"root_doc": "index", "extensions": ["no.such"]})
    with pytest.raises(GuideError, match="the guide cannot be built: Could not import extension"):
        site.build(tmp_path / "out")
    assert [path.name for path in tmp_path.iterdir()] == [pages.name]


def test_a_site_of_which_a_page_cannot_be_written_is_not_put_in_place(
    pages: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A directory comes where Sphinx is about to write a page: it warns, and would go on."""
    settings = {"extensions": ["myst_parser"], "source_suffix": {".md": "markdown"}}
    monkeypatch.setattr(site, "_settings", lambda: settings)

    def block(done: int, total: int, _page: str) -> None:
        if done == total:
            (made,) = (path.parent for path in tmp_path.rglob("_static"))
            (made / "index.html").mkdir(exist_ok=True)

    out = tmp_path / "out"
    with pytest.raises(
        GuideError, match=f"cannot be written whole: .*{out}.*; nothing was changed"
    ):
        site.build(out, block)
    assert [path.name for path in tmp_path.iterdir()] == [pages.name]


def test_a_command_may_go_over_lines_be_a_remark_or_nothing(tmp_path: Path) -> None:
    (tmp_path / "one.txt").write_text("hello\n")
    (tmp_path / "two.txt").write_text("there\n")
    text = page(
        fenced("sh", "# both files", "cat one.txt \\", "  two.txt", ""),
        fenced("console", "$ cat one.txt \\", "  two.txt", "old"),
        fenced("sh"),
        "```sh\n```",
    )
    ran = rerun("page.md", text, tmp_path)
    assert ran == text.replace("old", "hello\nthere")
