"""Fenced blocks of pages, run in order as a reader would run them.

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
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from api.docs.commands import CommandError, run

#: How commands begin that no page's test runs, and why.
NOT_RUN: Mapping[tuple[str, ...], str] = {
    ("make",): "sets up an environment or measures for minutes; CI runs these targets",
    ("git", "clone"): "fetches the repository",
    ("sunatlas", "leaderboard", "--check"): "measures every cell again: hours",
    ("sunatlas", "rank"): "needs the page's file: the recipes' test runs it in a copy of the tree",
}

_FENCE = re.compile(
    r"^(?P<indent>[ ]*)```(?P<language>[a-z]+)?(?P<info>[^\n`]*)\n(?P<body>.*?)^(?P=indent)```$",
    re.DOTALL | re.MULTILINE,
)
_REASON = re.compile(r"<!-- not run: (?P<reason>[^>]+?) -->\s*\Z")


class BlockError(Exception):
    """A block does not run, or prints something else; the message names page and line."""


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes
    ----------
    language
        As stated; empty where none is.
    info
        What else stands behind the language.
    body
        Its lines, without the fence's indent.
    line
        Of the opening fence, counted from 1.
    start, end
        Of the body in the page's text.
    reason
        Why it is not run; empty where it is.
    """

    language: str
    info: str
    body: str
    line: int
    start: int
    end: int
    reason: str


@dataclass
class Ran:
    """What came of a page: how much ran, and what did not, with reasons."""

    text: str
    python: int = 0
    commands: int = 0
    left_out: list[tuple[str, str]] = field(default_factory=list)


def blocks(text: str) -> list[Block]:
    """Return the fenced blocks of a page, in order."""
    found = []
    for match in _FENCE.finditer(text):
        reason = _REASON.search(text, 0, match.start())
        indent = match["indent"]
        found.append(
            Block(
                match["language"] or "",
                match["info"].strip(),
                re.sub(f"^{indent}", "", match["body"], flags=re.MULTILINE),
                text.count("\n", 0, match.start()) + 1,
                match.start("body"),
                match.end("body"),
                "" if reason is None else reason["reason"],
            )
        )
    return found


def rerun(page: str, text: str, directory: Path) -> Ran:
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
    found = blocks(text)
    namespace: dict[str, Any] = {"__name__": page}
    ran = Ran(text)
    printed: dict[int, str] = {}
    with contextlib.chdir(directory):
        for number, block in enumerate(found):
            where = f"{page}, line {block.line}"
            if block.reason:
                ran.left_out.append((f"{block.language} block, line {block.line}", block.reason))
            elif block.language == "python" and not block.info:
                said = _python(block, where, namespace)
                ran.python += 1
                behind = found[number + 1] if number + 1 < len(found) else None
                shown = behind is not None and _is_output(text, block, behind)
                if bool(said) != shown:
                    what = "prints, and no text block shows it" if said else "prints nothing"
                    raise BlockError(f"{where}: {what}")
                if behind is not None and shown:
                    printed[number + 1] = said
            elif block.language in {"console", "sh"}:
                printed[number] = "".join(_commands(block, where, ran))
    for number in sorted(printed, reverse=True):
        block = found[number]
        ran.text = ran.text[: block.start] + printed[number] + ran.text[block.end :]
    return ran


def _is_output(text: str, block: Block, behind: Block) -> bool:
    between = text[block.end : behind.start].removeprefix("```")
    return behind.language == "text" and between.split("```text")[0].strip() == ""


def _python(block: Block, where: str, namespace: dict[str, Any]) -> str:
    """Run a block of Python; return what it prints, without blanks that end a line."""
    said = io.StringIO()
    try:
        code = compile("\n" * block.line + block.body, where.partition(",")[0], "exec")
        with contextlib.redirect_stdout(said):
            exec(code, namespace)  # noqa: S102 - the page's own example
    except Exception as error:
        raise BlockError(f"{where} fails: {type(error).__name__}: {error}") from error
    return "".join(f"{line.rstrip()}\n" for line in said.getvalue().splitlines())


def _commands(block: Block, where: str, ran: Ran) -> Iterator[str]:
    """Run the commands of a block; give its lines with what each prints now."""
    shown = block.language == "console"
    for command, before in _split(block.body, shown=shown):
        yield f"$ {command}\n" if shown else f"{command}\n"
        words = shlex.split(command.replace("\\\n", " "), comments=True)
        if not words:
            continue
        reason = reason_not_to_run(words)
        if reason:
            ran.left_out.append((command, reason))
            if shown:
                yield before
            continue
        try:
            said = run(words)
        except CommandError as error:
            raise BlockError(f"{where}: `{command}`: {error}") from error
        ran.commands += 1
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
