"""Find tests that hold phrases: `python -m tools.phrases_in_tests --words 7`.

Lists each string of so many words or more within an assertion of a test: in an ``assert``, a
``match=`` of `pytest.raises`, or an argument of `pytest.mark.parametrize`. A test holds facts:
numbers, names, types; it should not fail because a sentence is worded better.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1] / "tests"
#: Words from which on a string is a phrase.
PHRASE = 7


def phrases(source: str, words: int = PHRASE) -> Iterator[tuple[int, str]]:
    """Give the line and text of each phrase that an assertion of this source holds."""
    seen: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        for part in _asserted(node):
            for one in ast.walk(part):
                if (
                    isinstance(one, ast.Constant)
                    and isinstance(one.value, str)
                    and len(one.value.split()) >= words
                    and "\n" not in one.value.strip()
                    and one.lineno not in seen
                ):
                    seen.add(one.lineno)
                    yield one.lineno, one.value


def _asserted(node: ast.AST) -> list[ast.AST]:
    """Return what a node asserts."""
    if isinstance(node, ast.Assert):
        return [node.test]
    if isinstance(node, ast.Call):
        found: list[ast.AST] = [one.value for one in node.keywords if one.arg == "match"]
        if isinstance(node.func, ast.Attribute) and node.func.attr == "parametrize":
            found += node.args[1:]
        return found
    return []


def main() -> int:
    """Print the phrases, a line each, and how many there are."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--words", type=int, default=PHRASE, help="words of the shortest phrase")
    options = parser.parse_args()
    count, files = 0, 0
    for path in sorted(ROOT.rglob("*.py")):
        found = sorted(phrases(path.read_text("utf-8"), options.words))
        count, files = count + len(found), files + bool(found)
        for line, text in found:
            sys.stdout.write(f"{path.relative_to(ROOT.parent)}:{line}: {text}\n")
    sys.stdout.write(f"{count} phrases of {options.words} words or more in {files} files\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
