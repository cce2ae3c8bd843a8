"""The docs: generated parts are what the code says now, and cannot be lost unnoticed."""

import shutil

import pytest

from api.docs import documentation
from api.docs.documentation import PAGES, DocumentationError, regenerate, renew_parts

PAGE = "prose\n<!-- generated: one -->\nold\n<!-- end: one -->\nmore prose\n"


@pytest.mark.slow
def test_the_committed_docs_are_current():
    assert regenerate(write=False) == [], "run `make docs`"


def test_what_is_altered_is_noticed_and_renewed(tmp_path, monkeypatch, capsys):
    docs = tmp_path / "docs"
    shutil.copytree(documentation.DIRECTORY, docs)
    pages = {"survey.md": PAGES["survey.md"]}
    monkeypatch.setattr(documentation, "every_page", lambda _: pages)
    monkeypatch.setattr(documentation, "every_picture", lambda: {"made.svg": lambda: "<svg/>"})
    monkeypatch.setattr(documentation, "RUN", ("guide/scores.md",))
    monkeypatch.setattr(documentation.regenerate, "__defaults__", (docs,))
    page = docs / "survey.md"
    good = page.read_text("utf-8")
    page.write_text(good.replace("129 studies", "130 studies"), "utf-8")
    run = docs / "guide" / "scores.md"
    true = run.read_text("utf-8")
    run.write_text(true.replace("[0.003 0.   ]", "[0.004 0.   ]"), "utf-8")
    assert documentation.main(["--check"]) == 1
    said = capsys.readouterr().err
    assert "docs/survey.md is behind" in said
    assert "docs/made.svg is behind" in said
    assert "docs/guide/scores.md is behind" in said
    assert "130 studies" in page.read_text("utf-8")
    assert not (docs / "made.svg").exists()
    assert documentation.main([]) == 0
    assert page.read_text("utf-8") == good
    assert run.read_text("utf-8") == true != ""
    assert (docs / "made.svg").read_text("utf-8") == "<svg/>"


def test_prose_stays_and_the_part_is_replaced():
    new = renew_parts("page.md", PAGE, {"one": lambda: "new\n"})
    assert new == "prose\n<!-- generated: one -->\n\nnew\n\n<!-- end: one -->\nmore prose\n"
    assert renew_parts("page.md", new, {"one": lambda: "new"}) == new


@pytest.mark.parametrize("parts", [("two",), ("one", "two"), ()])
def test_a_part_that_is_missing_or_unknown_is_named(parts):
    with pytest.raises(DocumentationError, match=r"page\.md: expected"):
        renew_parts("page.md", PAGE, {name: lambda: "" for name in parts})


def test_a_part_that_stands_twice_is_refused():
    with pytest.raises(DocumentationError, match="found one, one"):
        renew_parts("page.md", PAGE + PAGE, {"one": lambda: ""})
