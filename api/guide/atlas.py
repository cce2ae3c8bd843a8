"""Links from the guide back into the atlas: its parts at the top, and what pages name.

The guide is served below the atlas's own pages, so that their addresses start at the root.
"""

from __future__ import annotations

from functools import cache

from docutils import nodes

from api.addresses import NAVIGATION, algorithm_page, claim_page, dataset_page, study_page


def atlas_links() -> str:
    """Return links to the parts of the atlas, as HTML for the head of every page."""
    linked = (
        *((at, name) for at, name in NAVIGATION if at != "/guide"),
        ("/docs", "API reference"),
    )
    parts = [f'<a href="{at}">{name}</a>' for at, name in linked]
    return f"Sun Sensor Atlas: {' · '.join(parts)}"


def link_names(document: nodes.document) -> None:
    """Link what a page names as code to its page: data sets and claims, and methods in tables.

    In a sentence `lut` may be a word of the code; in a table it is a method.
    """
    everywhere, in_tables = _pages()
    for literal in list(document.findall(nodes.literal)):
        name = literal.astext()
        if _within(literal, (nodes.reference, nodes.title)):
            continue
        page = everywhere.get(name)
        if page is None and _within(literal, (nodes.entry,)):
            page = in_tables.get(name)
        if page is not None:
            # External, as Sphinx has it: an address that is none of the guide's pages.
            link = nodes.reference("", "", internal=False, refuri=page)
            literal.replace_self(link)
            link += literal


def _within(node: nodes.Node, kinds: tuple[type[nodes.Node], ...]) -> bool:
    above = node.parent
    while above is not None:
        if isinstance(above, kinds):
            return True
        above = above.parent
    return False


@cache
def _pages() -> tuple[dict[str, str], dict[str, str]]:
    from benchmark import datasets  # noqa: PLC0415 - slow to import, and only a build needs it
    from benchmark.claims.rules import claims  # noqa: PLC0415
    from registry.catalogue import catalogue  # noqa: PLC0415
    from registry.studies import facts  # noqa: PLC0415

    everywhere = {name: dataset_page(name) for name in datasets.names()}
    everywhere |= {name: claim_page(name) for name in claims()}
    everywhere |= {key: study_page(key) for key in facts("all").studies}
    in_tables = {one.name: algorithm_page(one.name) for one in catalogue().implementations(None)}
    return everywhere, in_tables
