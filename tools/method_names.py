"""Find methods that have more than one name, over pages, docs and the help of commands.

A pipeline is named ``extractor + model``, such as ``bctm + pinhole``. Another separator between the
name of an extractor and the name of a model (``>``, an arrow) is a second name.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from registry.catalogue import catalogue

ROOT = Path(__file__).resolve().parents[1]
#: Where readers meet names: templates, scripts of the page, commands, docs.
PLACES = (
    "README.md",
    "docs/**/*.md",
    "api/pages/templates/**/*.html",
    "api/static/*.js",
    "api/cli/**/*.py",
    "registry/*.py",
)
SEPARATORS = r"(?:>|→|-&gt;|->|&rarr;)"


def second_names(texts: Mapping[str, str], names: Iterable[str]) -> Iterator[tuple[str, int, str]]:
    """Give each place where a method is named with another separator than a plus sign.

    Parameters
    ----------
    texts : mapping of str to str
        Text by where it stands.
    names : iterable of str
        Names and labels of extractors and models.

    Yields
    ------
    tuple of str, int and str
        Where, number of the line, and the line.
    """
    word = "|".join(sorted(map(re.escape, names), key=len, reverse=True))
    named = re.compile(
        rf"(?<![\w-])(?:{word}|extractor['\"\]]*\s*}}+)`?\s*{SEPARATORS}\s*`?[\w${{]", re.IGNORECASE
    )
    for place, text in texts.items():
        for number, line in enumerate(text.splitlines(), start=1):
            if named.search(line):
                yield place, number, line.strip()


def texts(root: Path = ROOT) -> dict[str, str]:
    """Return what readers meet, by path."""
    found = {path for pattern in PLACES for path in root.glob(pattern)}
    return {str(path.relative_to(root)): path.read_text("utf-8") for path in sorted(found)}


def names() -> set[str]:
    """Return names of extractors; two letters, such as pm, are too short to differ from words."""
    return {one.name for one in catalogue().implementations("extractor") if len(one.name) > 2}


def main() -> int:
    """Print second names; the exit code is 1 if there are any."""
    found = list(second_names(texts(), names()))
    for place, number, line in found:
        sys.stdout.write(f"{place}:{number}: {line[:120]}\n")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
