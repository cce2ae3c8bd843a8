"""Fenced blocks of pages, found by Sybil and run in order as a reader would run them.

On a page Python blocks share one namespace, and all blocks one working directory. What a Python
block prints stands in the `text` block behind it; a `console` block holds commands (`$ ...`) with
what each prints; an `sh` block holds commands alone. A block that is not run says why, in a comment
ahead of it (`<!-- not run: REASON -->`).
"""

from __future__ import annotations

import io
import re
import shlex
from collections.abc import Iterator
from contextlib import chdir, nullcontext, redirect_stdout
from pathlib import Path

from sybil import Document, Example
from sybil.evaluators.python import PythonEvaluator
from sybil.parsers.markdown.lexers import RawFencedCodeBlockLexer
from typer.testing import CliRunner

from api.cli.command_line import app
from files.atomic import temporary_directory

#: How commands begin that no page's test runs: they set up an environment, measure for hours, or
#: need the page's file.
NOT_RUN = ("make ", "git clone ", "sunatlas leaderboard --check", "sunatlas rank ")
#: Columns of the terminal that pages are written for.
WIDTH = "88"

_FENCED = RawFencedCodeBlockLexer(re.compile(r"(?P<language>[a-z]*)(?P<info>[^\n]*)\n"))
_REASON = re.compile(r"<!-- not run: [^>]+ -->\s*\Z")
_COMMAND = re.compile(r"^\$ (?P<command>(?:.*\\\n)*.*)\n", re.MULTILINE)
_UNSHOWN = "no text block shows what the block before prints"


class BlockError(Exception):
    """A block does not run, or prints something else; the message names page and line."""


def blocks(page: str, text: str) -> Iterator[tuple[str, Example, bool]]:
    """Give the fenced blocks of a page: language with what stands behind it, block, to be run."""
    document = Document(text, page)
    document.namespace["__name__"] = page
    for region in _FENCED(document):
        region.parsed = region.lexemes["source"]
        document.add(region)
    for example in document:
        word = example.region.lexemes["language"] + example.region.lexemes["info"]
        yield word, example, _REASON.search(text, 0, example.start) is None


def rerun(page: str, text: str, directory: Path | None = None) -> str:
    """Run a page's blocks in a directory, a new one by default; return its text as they print now.

    BlockError where a block fails, or prints what no block behind it shows.
    """
    new, at, behind = "", 0, 0
    printed: str | None = None  # by the block of Python just run
    with nullcontext(directory) if directory else temporary_directory() as here, chdir(here):
        for word, example, wanted in blocks(page, text):
            start = example.start + example.parsed.offset
            end = start + len(example.parsed)
            shows = word == "text" and not text[behind : example.start].strip()
            behind = example.end
            try:
                if printed is not None and shows != bool(printed):
                    raise BlockError(  # noqa: TRY301 - with the line of the block, below
                        _UNSHOWN if printed else "the block before prints nothing"
                    )
                if printed:
                    new, at = new + text[at:start] + printed, end
                printed = None
                if wanted and word == "python":
                    printed = _python(example)
                elif wanted and word == "console":
                    new, at = new + text[at:start] + _console(example.parsed), end
                elif wanted and word == "sh":
                    for command in example.parsed.replace("\\\n", " ").splitlines():
                        _run(command)
            except Exception as error:
                said = f"{page}, line {example.line}: {type(error).__name__}: {error}"
                raise BlockError(said) from error
    if printed:
        raise BlockError(f"{page}: {_UNSHOWN}")
    return new + text[at:]


def _python(example: Example) -> str:
    said = io.StringIO()
    with redirect_stdout(said):
        PythonEvaluator()(example)
    return _trimmed(said.getvalue())


def _console(body: str) -> str:
    """Run the commands of a block; return its lines with what each prints now."""
    _, *parts = _COMMAND.split(body)
    if not parts or not body.startswith("$ "):
        raise BlockError(f"a console block starts with a command (`$ ...`); got {body[:40]!r}")
    shown = ""
    for command, before in zip(parts[::2], parts[1::2], strict=True):
        said = _run(command.replace("\\\n", " "))
        shown += f"$ {command}\n{before if said is None else said}"
    return shown


def _run(command: str) -> str | None:
    """Run a command in this process; return what it prints, None where it is not run."""
    plain = command.removeprefix(".venv/bin/")
    if plain.startswith(NOT_RUN):
        return None
    match shlex.split(plain, comments=True):
        case []:
            return ""
        case ["sunatlas", *words]:
            runner = CliRunner(env={"COLUMNS": WIDTH, "TERMINAL_WIDTH": WIDTH})
            done = runner.invoke(app, words, prog_name="sunatlas")
            if done.exit_code:
                raise BlockError(f"exit code {done.exit_code}: {done.output.strip()}")
            return _trimmed(done.stdout)
    raise BlockError(f"expected sunatlas; got {command}")


def _trimmed(text: str) -> str:
    return "".join(f"{line.rstrip()}\n" for line in text.strip("\n").splitlines())
