"""The guide's site: built without a warning, fetching nothing, with every page in a chapter."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from api.addresses import NAVIGATION
from api.guide import site
from api.guide.site import GuideError
from benchmark.progress import ProgressCallback
from tests.api.conftest import Client

DOCS = Path(__file__).resolve().parents[3] / "docs"
#: What a browser loads by itself, from wherever it says.
LOADED = re.compile(
    r"<(?:script|img|iframe|source)[^>]* src=\"([^\"]+)\"|<link[^>]* href=\"([^\"]+)\""
)

Built = tuple[Path, subprocess.CompletedProcess[str]]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """The site, built by the command in a process of its own."""
    out = tmp_path_factory.mktemp("guide") / "site"
    done = subprocess.run(
        [sys.executable, "-m", "api.cli.command_line", "guide", "build", "--strict",
         "--out", os.fspath(out)],
        cwd=DOCS.parent, capture_output=True, text=True, check=False,
    )  # fmt: skip
    return out, done


@pytest.fixture
def pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    directory = tmp_path / "docs"
    directory.mkdir()
    (directory / "index.md").write_text("# One\n")
    monkeypatch.setattr(site, "source", lambda: directory)
    return directory


def documented() -> list[str]:
    """Modules that the page on Python lists."""
    text = (DOCS / "guide" / "python.md").read_text("utf-8")
    return re.findall(r"^   ([a-z_]+(?:\.[a-z_]+)*)$", text, re.MULTILINE)


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(built: Built) -> None:
    out, done = built
    said = [line for line in done.stderr.splitlines() if not line.startswith("building the guide:")]
    assert (said, done.returncode) == ([], 0)
    assert done.stdout.endswith("0 warnings\n")
    pages = {path.relative_to(out).with_suffix("").as_posix() for path in out.rglob("*.html")}
    written = {path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.md")}
    modules = {f"guide/python/{name}" for name in documented()}
    assert len(modules) > 20
    assert pages == written | modules | {"search"}
    index = (out / "guide/python.html").read_text("utf-8")
    for name in documented():
        page = (out / f"guide/python/{name}.html").read_text("utf-8")
        assert f'href="python/{name}.html' in index
        assert re.search(rf'id="{re.escape(name)}\.\w', page), (name, "documents nothing")
    assert "<!-- built" not in "".join(path.read_text("utf-8") for path in out.rglob("*.html"))


@pytest.mark.slow
def test_no_page_loads_anything_from_elsewhere_or_has_a_script_of_its_own(built: Built) -> None:
    out, _ = built
    loaded = 0
    for page in out.rglob("*.html"):
        text = page.read_text("utf-8")
        assert not re.search(r"<script(?![^>]*\bsrc=)[^>]*>", text), page
        assert not re.search(r"<[a-z]+[^>]* on[a-z]+=\"", text), page
        for match in LOADED.finditer(text):
            target = (match[1] or match[2]).partition("?")[0]
            if "canonical" in match[0] or target.startswith("#"):
                continue
            assert not re.match(r"(?:[a-z]+:)?//", target), (page, target)
            assert (page.parent / target.partition("#")[0]).exists(), (page, target)
            loaded += 1
    assert loaded > 300
    for sheet in out.rglob("*.css"):
        assert not re.search(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", sheet.read_text("utf-8"))


@pytest.mark.slow
def test_equations_are_drawn_without_a_script(built: Built) -> None:
    out, _ = built
    text = (out / "models.html").read_text("utf-8")
    assert text.count("<math") > 40
    assert "$$" not in text
    assert not re.search(r"<m[io]>[^<]*\\", text), "a command that was not understood"


def test_a_guide_that_cannot_be_built_says_what_to_install(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setattr(site, "missing_builders", lambda: ("furo",))
    assert site.cached_site() is None
    for build in (site.keep, lambda: site.build(tmp_path / "out")):
        with pytest.raises(GuideError, match=r"needs furo: pip install .*\[guide\]"):
            build()
    assert not (tmp_path / "out").exists()


def test_the_site_of_changed_pages_is_another_and_the_oldest_are_let_go(
    pages: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("SUNATLAS_STORE", str(tmp_path))
    monkeypatch.setattr(site, "digest", site.digest.__wrapped__)
    places = []

    def build(place: Path, _progress: ProgressCallback) -> list[str]:
        place.mkdir(parents=True)
        os.utime(place, (len(places), len(places)))
        return ["a warning"]

    monkeypatch.setattr(site, "build", build)
    for number in range(site.KEPT + 2):
        (pages / "index.md").write_text(f"# {number}\n")
        places.append(site.cached_site())
        assert site.keep() == ["a warning"]
        assert site.keep() == [], "built once"
    assert len(set(places)) == len(places)
    assert sorted(path.is_dir() for path in places) == [False] * 2 + [True] * site.KEPT


@pytest.mark.slow
def test_every_page_leads_back_to_the_atlas_and_what_it_names_to_its_page(
    built: Built, atlas: Client
) -> None:
    out, _ = built
    links: dict[str, str] = {}
    for page in out.rglob("*.html"):
        found = re.findall(r'href="(/(?!guide")[^"/][^"]*|/)"', page.read_text("utf-8"))
        assert {pages[0][0] for pages in NAVIGATION.values()} - {"/guide"} <= set(found), page
        links |= dict.fromkeys(found, page.name)
    kinds = {link.split("/")[1] for link in links}
    assert {"algorithms", "datasets", "claims", "studies"} <= kinds
    assert sum(link.startswith("/algorithms/") for link in links) > 40
    for link, page_name in links.items():
        response = atlas.get(link, accept="text/html, */*;q=0.8")
        assert response.status_code == 200, (page_name, link)


def test_an_earlier_guide_is_replaced_and_nothing_else(pages: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    steps: list[tuple[int, int, str]] = []
    site.build(out, lambda *step: steps.append(step))
    assert [step[:2] for step in steps][:2] == [(1, 2), (2, 2)]
    assert "One" in (out / "index.html").read_text("utf-8")
    (pages / "index.md").write_text("# Two\n")
    site.build(out)
    assert "Two" in (out / "index.html").read_text("utf-8")
    (out / "objects.inv").write_bytes(b"# Sphinx inventory version 2\n# Project: Thesis\n")
    with pytest.raises(GuideError, match="something else than an earlier guide"):
        site.build(out)
    assert "Two" in (out / "index.html").read_text("utf-8")
