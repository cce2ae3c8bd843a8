"""Blocks of the guide, of the README and of the docs run, and show what they print."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from api.docs.blocks import BlockError, blocks, rerun
from api.docs.documentation import RUN

ROOT = Path(__file__).resolve().parents[3]
SLOW = {
    *("docs/guide/tutorial.md", "docs/guide/calibrate.md", "docs/guide/python.md"),
    *("docs/algorithms.md", "docs/datasets.md", "README.md"),
}
PAGES = sorted(
    path.relative_to(ROOT).as_posix() for path in [ROOT / "README.md", *ROOT.glob("docs/**/*.md")]
)


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=pytest.mark.slow) if n in SLOW else n for n in (*RUN, "README.md")],
)
def test_every_block_of_a_page_runs_and_prints_what_stands_there(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    (tmp_path / "work").mkdir()
    text = (ROOT / name).read_text("utf-8")
    assert rerun(name, text, tmp_path / "work") == text, f"{name} is behind; run `make docs`"


@pytest.mark.parametrize("name", PAGES)
def test_no_block_of_a_page_is_left_unrun_without_a_reason(name: str) -> None:
    for word, example, wanted in blocks(name, (ROOT / name).read_text("utf-8")):
        if word.startswith("python file="):
            compile(example.parsed, word, "exec")  # tests/test_architecture_recipes.py runs it
        elif wanted and name not in {*RUN, "README.md"}:
            # without a language: an outline; in braces: what the guide's build reads
            assert not word or word.startswith("{"), (example.line, word)


def page(*parts: str) -> str:
    return "\n\n".join(parts) + "\n"


def fenced(language: str, *lines: str) -> str:
    return "\n".join([f"```{language}", *lines, "```"])


def test_a_command_shows_what_it_prints_and_sh_shows_nothing(tmp_path: Path) -> None:
    text = page(fenced("console", "$ sunatlas --version", "old"), fenced("sh", "sunatlas plan -h"))
    ran = rerun("page.md", text, tmp_path)
    assert re.search(r"\$ sunatlas --version\nsunatlas [0-9.]+\n```", ran)
    assert ran.endswith("```sh\nsunatlas plan -h\n```\n")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (fenced("python", "print(1 / 0)"), "page.md, line 1: ZeroDivisionError"),
        (fenced("python", "print(1)"), "no text block"),
        (page(fenced("python", "a = 1"), fenced("text", "1")), "prints nothing"),
        (fenced("sh", "rm -r /"), "got rm"),
        (fenced("sh", "sunatlas no-such-command"), "exit code"),
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
    assert [wanted for _, _, wanted in blocks("page.md", text)] == [False]
    text = fenced("console", "$ make serve", "as it was") + "\n"
    assert rerun("page.md", text, tmp_path) == text
