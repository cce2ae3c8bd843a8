"""Find methods that have more than one name, over pages, docs and the help of commands.

A pipeline is named ``extractor + model``, such as ``bctm + pinhole``. Another separator between the
name of an extractor and the name of a model (``>``, an arrow) is a second name. Each method has one
display name (`algorithms.display_names`), which no other method has and which says whether the
method is our variant of the survey's.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from algorithms.display_names import DISPLAY_NAMES, VARIANT
from registry.catalogue import Implementation, catalogue

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
#: Start of the summary of a method whose default differs from the survey's form.
_OURS = "Our variant of "
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


def wrong_display_names(
    implementations: Iterable[Implementation], shown: Mapping[str, str] = DISPLAY_NAMES
) -> Iterator[str]:
    """Give each fault of the display names.

    Parameters
    ----------
    implementations : iterable of Implementation
        Of the catalogue.
    shown : mapping of str to str
        Display names by identifier.

    Yields
    ------
    str
        Identifier with the fault: none, that of another method, or one that hides or invents that
        the method is our variant of the survey's.
    """
    summaries: dict[str, str] = {}
    for one in implementations:
        for part in one.name.split(" + "):
            summaries.setdefault(part, one.summary if part == one.name else "")
    names = list(shown.values())
    for name, summary in summaries.items():
        display = shown.get(name)
        if display is None:
            yield f"{name}: no display name"
        elif names.count(display) > 1:
            yield f"{name}: {display} is the name of another method, too"
        elif summary.startswith(_OURS) != display.endswith(VARIANT):
            yield f"{name}: {display}: whether it is our variant differs from its summary"
    yield from (f"{name}: no such method" for name in shown if name not in summaries)


def texts(root: Path = ROOT) -> dict[str, str]:
    """Return what readers meet, by path."""
    found = {path for pattern in PLACES for path in root.glob(pattern)}
    return {str(path.relative_to(root)): path.read_text("utf-8") for path in sorted(found)}


def names() -> set[str]:
    """Return names of extractors; two letters, such as pm, are too short to differ from words."""
    return {one.name for one in catalogue().implementations("extractor") if len(one.name) > 2}


def main() -> int:
    """Print second and wrong names; the exit code is 1 if there are any."""
    found = list(second_names(texts(), names()))
    for place, number, line in found:
        sys.stdout.write(f"{place}:{number}: {line[:120]}\n")
    wrong = list(wrong_display_names(catalogue().implementations(None)))
    sys.stdout.writelines(f"{fault}\n" for fault in wrong)
    return 1 if found or wrong else 0


if __name__ == "__main__":
    sys.exit(main())
