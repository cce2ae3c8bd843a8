"""Reads labels, their numbers and titles out of a LaTeX source, as LaTeX counts them."""

from __future__ import annotations

import re
from collections import Counter

Named = tuple[str, str, str]

_COMMENT = re.compile(r"(?<!\\)%.*")
_TOKEN = re.compile(
    r"\\(?P<heading>section|subsection|subsubsection)(?P<star>\*?)\{(?P<title>[^{}]*)\}"
    r"|\\textbf\{(?P<paragraph>[^{}]*)\}(?=\s*\\label)"
    r"|\\begin\{(?P<begin>\w+)\*?\}|\\end\{(?P<end>\w+)\*?\}"
    r"|\\label\{(?P<label>[^{}]*)\}|\\caption\{(?P<caption>(?:[^{}]|\{[^{}]*\})*)\}"
    r"|(?P<appendix>\\appendix)|\\item\[(?P<item>(?:[^\[\]{}]|\{[^{}]*\})*)\]"
    r"|(?P<row>\\\\)|(?P<unnumbered>\\nonumber|\\notag)"
)
_EQUATIONS = {"equation", "align", "flalign"}
_FLOATS = {"figure", "table", "algorithm"}


def labels_of(text: str) -> dict[str, Named]:
    """Return kind, number and title of each label, in the order of the text."""
    reader = _Reader()
    for token in _TOKEN.finditer(_COMMENT.sub("", text)):
        assert token.lastgroup is not None
        kind = "heading" if token["heading"] else token.lastgroup
        getattr(reader, f"read_{kind}")(token)
    return reader.found


def skeleton(text: str) -> str:
    """Return what `labels_of` reads of a text, and no sentence of it."""
    kept = []
    for token in _TOKEN.finditer(_COMMENT.sub("", text)):
        caption = token["caption"]
        kept.append(token[0] if caption is None else f"\\caption{{{_plain(caption)}}}")
    return "\n".join(kept) + "\n"


class _Reader:
    """What has been met so far: counters, the last heading, open environments."""

    def __init__(self) -> None:
        self.found: dict[str, Named] = {}
        self.counts: Counter[str] = Counter()
        self.heading: Named = ("section", "", "")
        self.inside: list[str] = []
        self.waiting: list[str] = []  # labels whose number or title follows
        self.caption = ""
        self.numbered = True
        self.letters = False

    def nearest(self, kinds: set[str]) -> str:
        return next((name for name in reversed(self.inside) if name in kinds), "")

    def read_heading(self, token: re.Match[str]) -> None:
        kind, number = token["heading"], self.heading[1]
        if not token["star"]:
            self.counts[kind] += 1
            if kind == "section":
                self.counts["subsection"] = 0
            section = self.counts["section"]
            number = chr(ord("A") + section - 1) if self.letters else str(section)
            if kind == "subsection":
                number += f".{self.counts['subsection']}"
        self.heading = (kind, number, _plain(token["title"]))

    def read_paragraph(self, token: re.Match[str]) -> None:
        self.heading = ("paragraph", self.heading[1], _plain(token["paragraph"]))

    def read_appendix(self, token: re.Match[str]) -> None:
        self.letters, self.counts["section"] = True, 0

    def read_begin(self, token: re.Match[str]) -> None:
        self.inside.append(token["begin"])
        self.caption, self.numbered = "", True

    def read_end(self, token: re.Match[str]) -> None:
        if self.inside.pop() in _EQUATIONS:
            self._end_row()

    def read_row(self, token: re.Match[str]) -> None:
        if self.inside and self.inside[-1] in _EQUATIONS:
            self._end_row()
            self.numbered = True

    def read_unnumbered(self, token: re.Match[str]) -> None:
        self.numbered = False

    def read_caption(self, token: re.Match[str]) -> None:
        self.counts[self.nearest(_FLOATS)] += 1
        self.caption = _plain(token["caption"])

    def read_item(self, token: re.Match[str]) -> None:
        question = re.fullmatch(r"RQ (\d+) (.*?):?", _plain(token["item"]))
        if self.waiting and question is not None:
            self.found[self.waiting.pop()] = ("question", question[1], question[2])

    def read_label(self, token: re.Match[str]) -> None:
        floating = self.nearest(_FLOATS)
        if self.nearest(_EQUATIONS) or "description" in self.inside:
            self.waiting.append(token["label"])
        elif floating:
            self.found[token["label"]] = (floating, str(self.counts[floating]), self.caption)
        else:
            self.found[token["label"]] = self.heading

    def _end_row(self) -> None:
        """Count a row of an equation that has a number, and give it to the labels before it."""
        if self.numbered:
            self.counts["equation"] += 1
            for label in self.waiting:
                self.found[label] = ("equation", str(self.counts["equation"]), self.heading[2])
            self.waiting = []


def _plain(text: str) -> str:
    text = re.sub(r"\\cite\{[^{}]*\}", "", text)
    text = re.sub(r"\\text(?:it|tt|bf)\{([^{}]*)\}", r"\1", text)
    words = " ".join(text.replace("\\ ", " ").split()).replace(" ,", ",")
    return words.split(". ")[0].rstrip(" .,")
