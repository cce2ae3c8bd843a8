"""The guide where something is missing or fails: pages, builders, a file that cannot be written."""

from __future__ import annotations

import re
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from docutils import nodes

from api.docs.blocks import rerun
from api.guide import chapters, extension, site
from api.guide.site import GuideError
from tests.api.docs.test_guide_blocks import fenced, page


def test_pages_are_those_of_the_checkout_else_of_the_package_else_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    checkout, carried = tmp_path / "docs", tmp_path / "api" / "guide" / "source"
    monkeypatch.setattr(site, "_CHECKOUT", checkout)
    monkeypatch.setattr(site, "files", lambda _package: tmp_path / "api")
    with pytest.raises(GuideError, match=f"neither {checkout} nor the installed package has any"):
        site.source()
    for directory in (carried, checkout):
        directory.mkdir(parents=True)
        (directory / "index.md").write_text("# One\n")
        assert site.source() == directory


def test_pages_of_decisions_are_those_of_the_checkout_else_of_the_package_else_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = tmp_path / "api" / "guide"
    monkeypatch.setattr(chapters, "_HERE", here)
    assert chapters._decisions() == ()
    for docs, name in ((here / "source", "b-word"), (tmp_path / "docs", "a-word")):
        (docs / "decisions").mkdir(parents=True)
        for file in ("README", name):
            (docs / "decisions" / f"{file}.md").write_text("")
        assert chapters._decisions() == ("decisions/README", f"decisions/{name}")


def test_what_builds_the_guide_and_is_not_installed_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def version(name: str) -> str:
        if name != "sphinx":
            raise PackageNotFoundError(name)
        return "9"

    monkeypatch.setattr(site, "version", version)
    assert site.missing_builders.__wrapped__() == ("myst-parser", "furo")


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

    def block(done: int, total: int, _page: str, _share: float | None = None) -> None:
        if done == total:
            (made,) = (path.parent for path in tmp_path.rglob("_static"))
            (made / "index.html").mkdir(exist_ok=True)

    out = tmp_path / "out"
    with pytest.raises(
        GuideError, match=f"cannot be written whole: .*{out}.*; nothing was changed"
    ):
        site.build(out, block)
    assert [path.name for path in tmp_path.iterdir()] == [pages.name]


def test_a_page_without_a_script_is_not_written_again(tmp_path: Path) -> None:
    (tmp_path / "_static").mkdir()
    plain = tmp_path / "plain.html"
    plain.write_text("<p>plain</p>")
    plain.chmod(0o400)
    before = plain.stat().st_mtime_ns
    extension.scripts_apart(tmp_path)
    assert plain.read_text() == "<p>plain</p>"
    assert plain.stat().st_mtime_ns == before
    assert list((tmp_path / "_static").iterdir()) == []


@pytest.mark.parametrize("failed", [True, False])
def test_a_site_is_finished_only_where_it_was_built(tmp_path: Path, failed: bool) -> None:
    (tmp_path / "_static").mkdir()
    (tmp_path / "a.html").write_text("<script>one()</script>")
    app: Any = SimpleNamespace(outdir=str(tmp_path))
    extension._finish(app, OSError("full") if failed else None)
    assert ("one()" in (tmp_path / "a.html").read_text()) is failed


def test_equations_become_mathml_in_line_and_apart() -> None:
    body: list[str] = []
    translator = SimpleNamespace(body=body)
    for draw, node in ((extension._inline, nodes.math), (extension._block, nodes.math_block)):
        with pytest.raises(nodes.SkipNode):
            draw(translator, node("", "a^2"))
    assert ['display="inline"' in body[0], 'display="block"' in body[1]] == [True, True]
    assert re.fullmatch(r'<div class="equation"><math.*</math></div>\n', body[1], re.DOTALL)


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
    assert ran.text == text.replace("old", "hello\nthere")
    assert ran.commands == 2
    assert ran.left_out == []


def test_a_header_of_a_request_is_sent(tmp_path: Path) -> None:
    address = "http://127.0.0.1:8000/v1/taxonomy"
    text = page(fenced("console", f"$ curl -s -H 'Accept: text/csv' {address}", "old"))
    ran = rerun("page.md", text, tmp_path)
    assert "\nattribute," in ran.text
    assert "{" not in ran.text.split("old")[0].splitlines()[2]
