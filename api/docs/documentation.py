"""The generated parts that stand in git, of the README and of docs/, and what renews them.

Between `<!-- generated: NAME -->` and `<!-- end: NAME -->` a page has a part that is made here;
blocks of the guide's pages are run, and stand with what they print. `python -m
api.docs.documentation` renews all of it; `--check` names the files that are behind. All else that
the code knows is made when the guide is built (`api.docs.built_parts`).
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from api.docs import front
from api.docs.blocks import rerun
from api.metadata import codemeta
from api.metadata.identity import identity
from benchmark.processes import call_to_end
from benchmark.progress import console_progress
from files.atomic import replace_file

ROOT = Path(__file__).resolve().parents[2]

Make = Callable[[], str]
#: What makes each part of a page.
PAGES: Mapping[str, Mapping[str, Make]] = {
    "README.md": {"findings": front.findings, "tallies": front.tallies},
    "docs/leaderboard.md": {"architectures": front.best_per_architecture},
}
#: Files that are generated whole.
WHOLE: Mapping[str, Make] = {
    "docs/answer.svg": front.picture,
    codemeta.NAME: lambda: codemeta.codemeta_text(identity().citation),
}
#: Pages whose blocks are run, and what they print renewed.
RUN = (
    *("docs/algorithms.md", "docs/datasets.md", "docs/models.md"),
    *("docs/guide/tutorial.md", "docs/guide/calibrate.md", "docs/guide/scores.md"),
    *("docs/guide/python.md", "docs/guide/add-an-algorithm.md", "docs/guide/add-a-data-set.md"),
    "docs/guide/add-a-study.md",
)

_PART = re.compile(
    r"(?P<opening><!-- generated: (?P<name>[a-z-]+) -->\n).*?(?P<closing><!-- end: (?P=name) -->)",
    re.DOTALL,
)


def renew_parts(page: str, text: str, parts: Mapping[str, Make]) -> str:
    """Return a page with its generated parts renewed.

    ValueError where a part is missing, unknown, or there twice.
    """
    found = [match["name"] for match in _PART.finditer(text)]
    if sorted(found) != sorted(parts):
        raise ValueError(
            f"{page}: expected one generated part each of {', '.join(sorted(parts))}; "
            f"found {', '.join(sorted(found)) or 'none'}"
        )
    return _PART.sub(
        lambda match: f"{match['opening']}\n{parts[match['name']]().strip()}\n\n{match['closing']}",
        text,
    )


def regenerate(*, write: bool = True) -> list[str]:
    """Renew every page and file of this checkout; return the names of those that were behind."""
    texts = {page: (ROOT / page).read_text("utf-8") for page in (*PAGES, *RUN)}
    made: dict[str, Make] = dict(WHOLE)
    made |= {page: partial(renew_parts, page, texts[page], parts) for page, parts in PAGES.items()}
    made |= {page: partial(rerun, page, texts[page]) for page in RUN}
    behind = {}
    with console_progress("documenting") as report:
        for done, (name, make) in enumerate(made.items()):
            report(done, len(made), name)
            path, new = ROOT / name, make()
            if not path.is_file() or path.read_text("utf-8") != new:
                behind[name] = new
    for name, new in behind.items() if write else ():
        replace_file(ROOT / name, new)
    return sorted(behind)


def main(arguments: list[str] | None = None) -> int:
    """Renew the pages, or with --check only say which are behind (exit code 1)."""
    parser = argparse.ArgumentParser("python -m api.docs.documentation", description=main.__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing")
    options = parser.parse_args(arguments)
    behind = regenerate(write=not options.check)
    for name in behind:
        said = "is behind; run `make docs`" if options.check else "renewed"
        sys.stderr.write(f"{name} {said}\n")
    return 1 if behind and options.check else 0


if __name__ == "__main__":
    call_to_end(main)
