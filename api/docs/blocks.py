"""Fenced blocks of pages, found by Sybil and run in order as a reader would run them.

On a page Python blocks share one namespace, and all blocks one working directory. What a Python
block prints stands in the `text` block behind it; a `console` block holds commands (`$ ...`) with
what each prints; an `sh` block holds commands alone. A block that is not run says why, in a comment
ahead of it (`<!-- not run: REASON -->`); so do commands of `NOT_RUN`, wherever they stand.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path

from sybil import Document, Example
from sybil.evaluators.python import PythonEvaluator
from sybil.parsers.markdown.lexers import RawFencedCodeBlockLexer

from api.docs.commands import CommandError, run

#: How commands begin that no page's test runs, and why.
NOT_RUN: Mapping[tuple[str, ...], str] = {
    ("make",): "sets up an environment or measures for minutes; CI runs these targets",
    ("git", "clone"): "fetches the repository",
    ("sunatlas", "leaderboard", "--check"): "measures every cell again: hours",
    ("sunatlas", "rank"): "needs the page's file: the recipes' test runs it in a copy of the tree",
}

_BLOCKS = RawFencedCodeBlockLexer(re.compile(r"(?P<language>[a-z]*)(?P<info>[^\n]*)\n"))
_REASON = re.compile(r"<!-- not run: (?P<reason>[^>]+?) -->\s*\Z")


class BlockError(Exception):
    """A block does not run, or prints something else; the message names page and line."""


class Block:
    """A fenced block.

    Attributes
    ----------
    example
        As Sybil has it.
    language, info
        As stated, and what stands behind that; empty where nothing is.
    body
        Its lines, without the fence's indent.
    line
        Of the opening fence, counted from 1.
    start, end
        Of the body in the page's text.
    reason
        Why it is not run; empty where it is.
    """

    def __init__(self, example: Example) -> None:
        text, lexemes = example.document.text, example.region.lexemes
        self.example, self.line, self.body = example, example.line, str(example.parsed)
        self.language, self.info = lexemes["language"], lexemes["info"].strip()
        self.start = example.start + example.parsed.offset
        self.end = text.rindex("\n", 0, example.end) + 1
        found = _REASON.search(text, 0, example.start)
        self.reason = "" if found is None else found["reason"]


def blocks(text: str, page: str = "") -> list[Block]:
    """Return the fenced blocks of a page, in order; those of Python share a namespace."""
    document = Document(text, page)
    document.namespace["__name__"] = page
    for region in _BLOCKS(document):
        region.parsed = region.lexemes["source"]
        document.add(region)
    return [Block(example) for example in document]


def rerun(page: str, text: str, directory: Path) -> str:
    """Run a page's blocks; return its text with what they print now.

    Parameters
    ----------
    page : its name, for messages
    text : Markdown
    directory : that blocks run in, and may write to

    Raises
    ------
    BlockError
        Where a block fails, or prints what no block behind it shows.
    """
    found = blocks(text, page)
    printed: dict[Block, str] = {}
    with contextlib.chdir(directory):
        for block, behind in zip(found, [*found[1:], None], strict=True):
            where = f"{page}, line {block.line}"
            if block.reason:
                continue
            if block.language == "python" and not block.info:
                said = _python(block, where)
                shown = behind is not None and _is_output(text, block, behind)
                if bool(said) != shown:
                    what = "prints, and no text block shows it" if said else "prints nothing"
                    raise BlockError(f"{where}: {what}")
                if behind is not None and shown:
                    printed[behind] = said
            elif block.language in {"console", "sh"}:
                printed[block] = "".join(_commands(block, where))
    for block in sorted(printed, key=lambda block: block.start, reverse=True):
        text = text[: block.start] + printed[block] + text[block.end :]
    return text


def _is_output(text: str, block: Block, behind: Block) -> bool:
    between = text[block.example.end : behind.example.start]
    return behind.language == "text" and not between.strip()


def _python(block: Block, where: str) -> str:
    """Run a block of Python; return what it prints, without blanks that end a line."""
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            PythonEvaluator()(block.example)
    except Exception as error:
        raise BlockError(f"{where} fails: {type(error).__name__}: {error}") from error
    return "".join(f"{line.rstrip()}\n" for line in said.getvalue().splitlines())


def _commands(block: Block, where: str) -> Iterator[str]:
    """Run the commands of a block; give its lines with what each prints now."""
    shown = block.language == "console"
    for command, before in _split(block.body, shown=shown):
        yield f"$ {command}\n" if shown else f"{command}\n"
        words = shlex.split(command.replace("\\\n", " "), comments=True)
        if not words:
            continue
        if reason_not_to_run(words):
            yield before
            continue
        try:
            said = run(words)
        except CommandError as error:
            raise BlockError(f"{where}: `{command}`: {error}") from error
        if shown:
            yield said


def reason_not_to_run(words: list[str]) -> str:
    """Return why a command is not run; empty where it is."""
    plain = [
        word.removeprefix(".venv/bin/") if word.endswith("sunatlas") else word for word in words
    ]
    for start, reason in NOT_RUN.items():
        if tuple(plain[: len(start)]) == start:
            return reason
    return ""


def _split(body: str, *, shown: bool) -> Iterator[tuple[str, str]]:
    """Give each command of a block, of several lines or one, with what stands behind it."""
    command, behind = None, ""
    for line in body.splitlines():
        if command is not None and command.endswith("\\"):
            command += f"\n{line}"
        elif not shown or line.startswith("$ "):
            if command is not None:
                yield command, behind
            command, behind = line.removeprefix("$ ") if shown else line, ""
        elif command is None:
            raise BlockError(f"a console block starts with a command (`$ ...`); got {line!r}")
        else:
            behind += f"{line}\n"
    if command is not None:
        yield command, behind
