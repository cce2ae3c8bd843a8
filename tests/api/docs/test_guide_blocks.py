"""Blocks of the guide, of the README and of the docs run, and show what they print."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import pytest

from api.docs import documentation, model_pages
from api.docs.blocks import NOT_RUN, BlockError, blocks, reason_not_to_run, rerun

ROOT = Path(__file__).resolve().parents[3]
SLOW = {
    *("docs/guide/tutorial.md", "docs/guide/calibrate.md", "docs/guide/python.md"),
    *("docs/algorithms.md", "README.md"),
}
RUN = sorted([*(f"docs/{page}" for page in documentation.RUN), "docs/algorithms.md", "README.md"])
PAGES = sorted(
    path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]
)
#: Where blocks are made of running code when the docs are renewed, which tests/api/docs checks.
MADE = {
    "docs/http.md": {"http", "json"},
    "docs/command-line.md": {"text"},
    "docs/datasets.md": {"python", "text", "sh"},
}


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in RUN]
)
def test_every_block_of_a_page_runs_and_prints_what_stands_there(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "work").mkdir()
    text = (ROOT / name).read_text("utf-8")
    assert rerun(name, text, tmp_path / "work") == text, f"{name} is behind; run `make docs`"
    known = [block for block in blocks(text) if block.language in {"python", "sh", "console"}]
    assert [block for block in known if not block.reason]


@pytest.mark.parametrize("name", PAGES)
def test_no_block_of_a_page_is_left_unrun_without_a_reason(name: str) -> None:
    found = blocks((ROOT / name).read_text("utf-8"))
    unknown = []
    model = name.removeprefix("docs/") in {model_pages.page_of(c) for c in model_pages.categories()}
    for block in found:
        recipe = block.language == "python" and block.info.startswith("file=")
        if recipe:
            compile(block.body, block.info, "exec")  # tests/test_architecture_recipes.py runs it
        elif not (
            name in RUN
            or block.reason
            or block.language in MADE.get(name, ())
            or (model and block.language in {"python", "text"})
            or (block.language == "" and name == "docs/architecture.md")
            or block.info == "{eval-rst}"  # which the guide's build reads
        ):
            unknown.append((block.line, block.language))
    assert unknown == []


def test_what_is_not_run_is_little_and_every_reason_is_used() -> None:
    left = Counter[str]()
    for name in [*RUN, "CONTRIBUTING.md"]:
        for block in blocks((ROOT / name).read_text("utf-8")):
            if block.language in {"sh", "console"}:
                lines = [line.removeprefix("$ ").split() for line in block.body.splitlines()]
                left.update(reason_not_to_run(words) for words in lines if words)
    run = left.pop("")
    assert sum(left.values()) < run
    assert set(left) == set(NOT_RUN.values()), "a reason that no page needs"


def page(*parts: str) -> str:
    return "\n\n".join(parts) + "\n"


def fenced(language: str, *lines: str) -> str:
    return "\n".join([f"```{language}", *lines, "```"])


def test_python_shares_a_namespace_and_the_output_behind_it_is_renewed(tmp_path: Path) -> None:
    text = page(
        fenced("python", "a = 2"), "prose", fenced("python", "print(a)"), fenced("text", "?")
    )
    ran = rerun("page.md", text, tmp_path)
    assert ran == text.replace("?", "2")
    assert rerun("page.md", ran, tmp_path) == ran


def test_a_command_shows_what_it_prints_and_sh_shows_nothing(tmp_path: Path) -> None:
    (tmp_path / "one.txt").write_text("hello\n")
    text = page(fenced("console", "$ cat one.txt", "$ ls", "old"), fenced("sh", "ls  # all"))
    ran = rerun("page.md", text, tmp_path)
    assert "one.txt\nhello\n$ ls\none.txt\n```" in ran
    assert ran.endswith("```sh\nls  # all\n```\n")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (fenced("python", "print(1 / 0)"), "page.md, line 1 fails: ZeroDivisionError"),
        (fenced("python", "print(1)"), "no text block"),
        (page(fenced("python", "a = 1"), fenced("text", "1")), "prints nothing"),
        (fenced("sh", "rm -r /"), "got rm"),
        (fenced("console", "ls"), "starts with a command"),
        (fenced("sh", "sunatlas no-such-command"), "exit code"),
        (fenced("sh", "curl 'http://127.0.0.1:8000/v1/nothing'"), "404"),
        (fenced("sh", "curl 'https://example.org/'"), "expected an address at"),
    ],
)
def test_what_fails_is_named_with_its_page_and_line(
    tmp_path: Path, text: str, message: str
) -> None:
    with pytest.raises(BlockError, match=re.escape(message)):
        rerun("page.md", text, tmp_path)


def test_a_block_that_is_not_run_says_why(tmp_path: Path) -> None:
    text = page("<!-- not run: needs a telescope -->", fenced("python", "raise SystemExit"))
    assert rerun("page.md", text, tmp_path) == text
    assert [block.reason for block in blocks(text)] == ["needs a telescope"]
    text = fenced("console", "$ make serve", "as it was") + "\n"
    assert rerun("page.md", text, tmp_path) == text
