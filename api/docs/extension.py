"""Extension of Sphinx: what makes docs/ the site at /guide, which fetches nothing.

Parts of pages that the code knows are made when the site is built (`<!-- built: NAME -->`),
equations become MathML, scripts that the theme writes into pages become files (the service allows
no others), and data sets, claims, studies and methods that a page names lead to their pages.
"""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

from api.addresses import PAGES, algorithm_page, claim_page, dataset_page, study_page
from api.docs.built_parts import PARTS
from api.mathml import mathml
from api.pages.rendering import environment
from benchmark import datasets
from benchmark.claims.rules import claims
from registry.catalogue import catalogue
from registry.studies import facts

_BUILT = re.compile(r"<!-- built: (?P<name>[a-z-]+) -->")
_INLINE_SCRIPT = re.compile(r"<script>(?P<code>.+?)</script>", re.DOTALL)
#: Addresses of the atlas that pages name as code.
_PLACES = ("/openapi.json", "/search")


def setup(app: Sphinx) -> dict[str, Any]:
    """Register with Sphinx."""
    app.add_html_math_renderer("mathml", (_draw, None), (_draw, None))
    app.connect("source-read", _fill)
    app.connect("doctree-read", lambda _app, document: link_names(document))
    app.connect("build-finished", _finish)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}


def link_names(document: nodes.document) -> None:
    """Link what a page names as code to its page in the atlas.

    In a sentence `lut` may be a word of the code; in a table or a heading's list it is a method.
    """
    everywhere, in_tables = _pages()
    for literal in list(document.findall(nodes.literal)):
        above = {type(node) for node in _above(literal)}
        if above & {nodes.reference, nodes.title}:
            continue
        name = literal.astext()
        page = everywhere.get(name) or (in_tables.get(name) if nodes.entry in above else None)
        if page is not None:
            # External, as Sphinx has it: an address that is none of the guide's pages.
            link = nodes.reference("", "", internal=False, refuri=page)
            literal.replace_self(link)
            link += literal


def finish_page(page: Path, site: Path) -> None:
    """Put the atlas's head on a page, move scripts to files, let the keyboard scroll its code."""
    up = "../" * (len(page.relative_to(site).parts) - 1)

    def apart(match: re.Match[str]) -> str:
        name = f"inline-{hashlib.sha256(match['code'].encode()).hexdigest()[:12]}.js"
        (site / "_static" / name).write_text(match["code"], "utf-8")
        return f'<script src="{up}_static/{name}"></script>'

    text = _INLINE_SCRIPT.sub(apart, page.read_text("utf-8")).replace("<pre>", '<pre tabindex="0">')
    caption = 'class="caption" role="heading"'
    head = environment().get_template("masthead.html")
    drawn = head.render(section="Guide", part="/guide", icon=f"{up}_static/icon.svg")
    text = text.replace('<div class="page">', f'{drawn}<div class="page">', 1)
    page.write_text(text.replace(caption, f'{caption} aria-level="2"'), "utf-8")


def _above(node: nodes.Node) -> list[nodes.Node]:
    return [] if node.parent is None else [node.parent, *_above(node.parent)]


@cache
def _pages() -> tuple[dict[str, str], dict[str, str]]:
    everywhere = {name: dataset_page(name) for name in datasets.names()}
    everywhere |= {name: claim_page(name) for name in claims()}
    everywhere |= {key: study_page(key) for key in facts("all").studies}
    everywhere |= {place: place for place in (*dict(PAGES), *_PLACES) if place != "/"}
    in_tables = {one.name: algorithm_page(one.name) for one in catalogue().implementations(None)}
    return everywhere, in_tables


def _fill(app: Sphinx, page: str, source: list[str]) -> None:  # noqa: ARG001 - Sphinx's signature
    source[0] = _BUILT.sub(lambda part: PARTS[part["name"]](), source[0])


def _finish(app: Sphinx, error: Exception | None) -> None:
    if error is None:
        for page in sorted(Path(app.outdir).rglob("*.html")):
            finish_page(page, Path(app.outdir))


def _draw(translator: Any, node: nodes.math | nodes.math_block) -> None:
    block = isinstance(node, nodes.math_block)
    drawn = mathml(node.astext(), block=block)
    translator.body.append(f'<div class="equation">{drawn}</div>\n' if block else drawn)
    raise nodes.SkipNode
