"""Find tests that hold phrases: `python -m tools.phrases_in_tests --words 7`.

Lists each string of so many words or more within an assertion of a test: in an ``assert``, a
``match=`` of `pytest.raises`, or the last column of `pytest.mark.parametrize`, in which a test has
what it expects. A test holds facts: numbers, names, types; it should not fail because a sentence
is worded better. What a test puts in is left out: other columns, and texts that a call compared
with its outcome is given.
"""

from __future__ import annotations

import argparse
import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1] / "tests"
#: Words from which on a string is a phrase.
PHRASE = 7
PUNCTUATION = ".,;:!?()'\"`“”"
#: Words in plain letters without which a string is a formula, a pattern or a list of numbers.
PLAIN = 3


def phrases(source: str, words: int = PHRASE) -> Iterator[tuple[int, str]]:
    """Give the line and text of each phrase that an assertion of this source holds."""
    seen: set[int] = set()
    for node in ast.walk(ast.parse(source)):
        for part in _asserted(node):
            inputs = set(_inputs(part))
            for one in ast.walk(part):
                if (
                    isinstance(one, ast.Constant)
                    and isinstance(one.value, str)
                    and one not in inputs
                    and _is_phrase(one.value, words)
                    and one.lineno not in seen
                ):
                    seen.add(one.lineno)
                    yield one.lineno, one.value


def _is_phrase(text: str, words: int) -> bool:
    """Say whether a string is a line of so many words or more, some of them in plain letters."""
    found = [word for word in text.split() if re.search(r"[^\W_]", word)]
    plain = [word for word in found if re.fullmatch(r"[A-Za-z][a-z]+", word.strip(PUNCTUATION))]
    return len(found) >= words and len(plain) >= PLAIN and "\n" not in text.strip()


def _asserted(node: ast.AST) -> list[ast.AST]:
    """Return what a node asserts."""
    if isinstance(node, ast.Assert):
        return [node.test]
    if isinstance(node, ast.Call):
        found: list[ast.AST] = [one.value for one in node.keywords if one.arg == "match"]
        if isinstance(node.func, ast.Attribute) and node.func.attr == "parametrize":
            found += _expected(node.args[1:])
        return found
    return []


def _expected(cases: list[ast.expr]) -> Iterator[ast.AST]:
    """Give the last column of the cases of a test; a column alone is what is put in."""
    for one in cases:
        if not isinstance(one, ast.List | ast.Tuple):
            yield one
            continue
        for case in one.elts:
            if isinstance(case, ast.Tuple):
                yield from case.elts[-1:]
            elif isinstance(case, ast.Call):  # pytest.param
                yield from case.args[1:][-1:]


def _inputs(part: ast.AST) -> Iterator[ast.AST]:
    """Give the texts of the calls whose outcome is compared, as in ``f("text") == 3``."""
    for one in ast.walk(part):
        if isinstance(one, ast.Compare):
            for side in (one.left, *one.comparators):
                if isinstance(side, ast.Call) and isinstance(side.func, ast.Name):
                    yield from side.args


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
