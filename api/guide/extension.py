"""Extension of Sphinx: what makes docs/ a site that fetches nothing.

Equations become MathML when the site is built, scripts that the theme writes into pages become
files (the service allows no others), and links to files of the repository that are no pages become
their paths.
"""

from __future__ import annotations

import hashlib
import os
import re
from pathlib import Path, PurePosixPath
from typing import Any

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx

from api.guide.atlas import link_names
from api.guide.chapters import ROOT, toctrees
from api.mathml import mathml

#: A link whose target is a path, not an address and not an anchor alone.
_LINK = re.compile(r"(?<!!)\[(?P<text>[^\]\[]+)\]\((?P<target>[^)#:\s]+)(?P<anchor>#[^)\s]*)?\)")
_FENCED = re.compile(r"(^```.*?^```$)", re.DOTALL | re.MULTILINE)
_INLINE_SCRIPT = re.compile(r"<script>(?P<code>.+?)</script>", re.DOTALL)


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    # Requests in the docs have no version line, which the lexer of HTTP asks for.
    app.add_lexer("http", TextLexer)
    app.connect("source-read", _read)
    app.connect("doctree-read", _name_of)
    app.connect("build-finished", _finish)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def within(page: str, text: str) -> str:
    """Return a page's text with links out of docs/ as the paths that they name.

    Parameters
    ----------
    page : its name in docs/, without suffix
    text : Markdown; what is fenced stays as it is
    """
    folder = PurePosixPath(page).parent

    def plain(match: re.Match[str]) -> str:
        path = os.path.normpath(folder / match["target"])
        if not path.startswith(".."):
            return match[0]
        name = path.removeprefix("../")
        word = match["text"].strip("`")
        return f"`{name}`" if word in name else f"{match['text']} (`{name}`)"

    parts = _FENCED.split(text)
    return "".join(part if part.startswith("```") else _LINK.sub(plain, part) for part in parts)


def scripts_apart(site: Path) -> None:
    """Move scripts that stand in pages to files of their own, so that a strict policy allows them.

    Parameters
    ----------
    site : of HTML, changed in place
    """
    for page in sorted(site.rglob("*.html")):
        text = page.read_text("utf-8")
        up = "../" * (len(page.relative_to(site).parts) - 1)

        def apart(match: re.Match[str], up: str = up) -> str:
            name = f"inline-{hashlib.sha256(match['code'].encode()).hexdigest()[:12]}.js"
            (site / "_static" / name).write_text(match["code"], "utf-8")
            return f'<script src="{up}_static/{name}"></script>'

        new = _INLINE_SCRIPT.sub(apart, text)
        if new != text:
            page.write_text(new, "utf-8")


def made_reachable(site: Path) -> None:
    """Let the keyboard scroll blocks of code, and give headings of the sidebar their level.

    Parameters
    ----------
    site : of HTML, changed in place
    """
    for page in sorted(site.rglob("*.html")):
        text = page.read_text("utf-8")
        new = text.replace("<pre>", '<pre tabindex="0">')
        new = new.replace(
            'class="caption" role="heading"', 'class="caption" role="heading" aria-level="2"'
        )
        page.write_text(new, "utf-8")


def _read(app: Sphinx, page: str, source: list[str]) -> None:  # noqa: ARG001 - Sphinx's signature
    source[0] = within(page, source[0]) + (toctrees() if page == ROOT else "")


def _name_of(app: Sphinx, document: nodes.document) -> None:  # noqa: ARG001 - Sphinx's signature
    link_names(document)


def _finish(app: Sphinx, error: Exception | None) -> None:
    if error is None:
        scripts_apart(Path(app.outdir))
        made_reachable(Path(app.outdir))


def _inline(translator: Any, node: nodes.math) -> None:
    translator.body.append(mathml(node.astext()))
    raise nodes.SkipNode


def _block(translator: Any, node: nodes.math_block) -> None:
    drawn = mathml(node.astext(), block=True)
    translator.body.append(f'<div class="equation">{drawn}</div>\n')
    raise nodes.SkipNode
