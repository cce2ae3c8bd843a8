"""Text that readers meet, as blocks: paragraphs, list items, cells, headings.

Code, markup and numbers of tables are left out; code inside a sentence stays as a word.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
DOCUMENTS = ("README.md", "CONTRIBUTING.md", "docs/**/*.md")
TEMPLATES = "api/pages/templates/**/*.html"

_FENCE = re.compile(r"^\s*(?:```|~~~|\$\$)")
_BULLET = re.compile(r"^\s*(?:[-*]|\d+\.)\s+")
_CODE = re.compile(r"`+[^`]*`+")
_LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
_MARK = re.compile(r"\*{1,3}|(?<!\w)_{1,3}(?=\w)|(?<=\w)_{1,3}(?!\w)|<!--.*?-->|<[^>\s][^>]*>")
_FORMULA = re.compile(r"\$[^$\n]+\$")
_JINJA = re.compile(r"\{#.*?#\}|\{%.*?%\}|\{\{.*?\}\}", re.DOTALL)
#: Elements within a sentence; every other one ends it.
_INLINE = frozenset(("a", "abbr", "b", "em", "i", "small", "span", "strong", "sub", "sup", "time"))
_SILENT = frozenset({"script", "style", "svg", "code", "math", "textarea"})
_SENTENCE_END = re.compile(r"(?<=[.!?])[\"”)]?\s+(?=[\"“(A-Z`-])")
_ABBREVIATION = re.compile(
    r"(?:\b(?:e\.g|i\.e|Ap|Proc|vol|no|pp|vs|approx|Eq|Fig|Sect|\b[A-Z])|^\d+)\.$"
)


@dataclass(frozen=True)
class Block:
    """Words that stand together, with the file or address they are of and its line."""

    where: str
    line: int
    text: str


def sentences(text: str) -> list[str]:
    """Split a block into sentences."""
    found: list[str] = []
    for part in _SENTENCE_END.split(text):
        if found and _ABBREVIATION.search(found[-1]):
            found[-1] += " " + part
        else:
            found.append(part.strip())
    return [one for one in found if one]


def markdown(where: str, text: str) -> Iterator[Block]:
    """Give the blocks of a Markdown page."""
    waiting: list[str] = []
    start, fenced = 0, False
    for number, line in enumerate([*text.splitlines(), ""], start=1):
        fence = bool(_FENCE.match(line))
        if fence and not (line.strip().startswith("$$") and line.strip().count("$$") == 2):
            fenced = not fenced
        if line.startswith("    ") and not waiting and not _BULLET.match(line):
            continue  # code that is indented
        row = line.lstrip().startswith("|")
        ends = fence or fenced or row or not line.strip() or line.startswith("#")
        if waiting and (ends or _BULLET.match(line)):
            yield Block(where, start, _plain(" ".join(waiting)))
            waiting = []
        if fence or fenced or not line.strip():
            continue
        if row:
            cells = (cell.strip() for cell in line.strip().strip("|").split(" | "))
            yield from (Block(where, number, _plain(cell)) for cell in cells if _says(cell))
        elif line.startswith("#"):
            yield Block(where, number, _plain(line.lstrip("# ")))
        else:
            start = start if waiting else number
            waiting.append(_BULLET.sub("", line).strip())


def html(where: str, text: str) -> Iterator[Block]:
    """Give the blocks of a page, or of a template without what is filled in."""
    reader = _Reader()
    reader.feed(_JINJA.sub(_filled_in, text))
    reader.close()
    reader.end_block()
    for line, said in reader.blocks:
        yield Block(where, line, said)


def _filled_in(found: re.Match[str]) -> str:
    """Leave a mark where a value is filled in, and the lines as they are."""
    return ("…" if found[0].startswith("{{") else "") + "\n" * found[0].count("\n")


def documents(root: Path = ROOT) -> Iterator[Block]:
    """Give the blocks of README, CONTRIBUTING and docs."""
    for path in sorted({path for pattern in DOCUMENTS for path in root.glob(pattern)}):
        yield from markdown(str(path.relative_to(root)), path.read_text("utf-8"))


def templates(root: Path = ROOT) -> Iterator[Block]:
    """Give the fixed text of the pages' templates."""
    for path in sorted(root.glob(TEMPLATES)):
        yield from html(str(path.relative_to(root)), path.read_text("utf-8"))


def help_texts() -> Iterator[Block]:
    """Give the help of every command and option."""
    from api.cli.command_line import COMMANDS, load

    for name in COMMANDS:
        yield from _command(f"sunatlas {name}", load(name))


def openapi() -> Iterator[Block]:
    """Give summaries and descriptions of the HTTP API."""
    from api.http.openapi_sharing import inlined
    from api.server.app import create_app

    for path, operations in inlined(create_app().openapi()).items():
        for method, operation in operations.items():
            where = f"{method.upper()} {path}"
            said = [operation.get("summary"), *(operation.get("description") or "").split("\n\n")]
            said += [one.get("description") for one in operation.get("parameters", ())]
            yield from (Block(where, 0, _plain(one)) for one in said if one)


def _command(where: str, command: Any) -> Iterator[Block]:
    for paragraph in (command.help or "").split("\n\n"):
        if paragraph.strip():
            yield Block(where, 0, _plain(paragraph))
    for option in command.params:
        if said := getattr(option, "help", None):
            yield Block(f"{where} {option.opts[0]}", 0, _plain(said))
    for name, below in getattr(command, "commands", {}).items():
        yield from _command(f"{where} {name}", below)


def _plain(text: str) -> str:
    """Return text without markup; a code becomes a word, an equation a symbol."""
    text = _LINK.sub(r"\1", text)
    codes: list[str] = []

    def keep(found: re.Match[str]) -> str:
        codes.append(found[0].strip("`").replace(". ", "."))
        return f"\0{len(codes) - 1}\0"

    text = _FORMULA.sub(lambda found: f"`{found[0].strip('$')}`", text)
    text = _MARK.sub("", _CODE.sub(keep, text))
    return " ".join(re.sub("\0(\\d+)\0", lambda at: f"`{codes[int(at[1])]}`", text).split())


def _says(cell: str) -> bool:
    """Return whether a cell holds words, and not a number, a mark or a name alone."""
    return len(re.findall(r"[A-Za-z]{2,}", cell)) > 1


class _Reader(HTMLParser):
    """Collects the text of blocks, each with its line."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.blocks: list[tuple[int, str]] = []
        self._words: list[str] = []
        self._line = 1
        self._silent: list[str] = []

    def end_block(self) -> None:
        said = " ".join("".join(self._words).split())
        if _says(said):
            self.blocks.append((self._line, said))
        self._words = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in _INLINE | _SILENT:
            self.end_block()
        if tag in _SILENT:
            self._silent.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in _INLINE | _SILENT:
            self.end_block()
        if self._silent and self._silent[-1] == tag:
            self._silent.pop()
            if tag in {"code", "math"}:
                self._words.append(" … ")

    def handle_data(self, data: str) -> None:
        if self._silent:
            return
        if not self._words:
            self._line = self.getpos()[0]
        self._words.append(data)
