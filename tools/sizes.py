"""Print how large the code is: `python -m tools.sizes`, by part of the repository and in all.

Lines are those of Python files; code is what is left without blank lines, comments and docstrings.
"""

from __future__ import annotations

import ast
import io
import subprocess
import sys
import tokenize
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_SILENT = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
#: Part -> its folders and files (code), and those of its tests; paths begin with one of them.
PARTS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "development programs": (("tools/",), ("tests/tools/",)),
    "digests of code": (
        ("benchmark/results/modules",),
        ("tests/benchmark/results/test_modules",),
    ),
    "running many processes": (
        tuple(f"benchmark/running/{name}" for name in ("times", "workers", "cluster")),
        tuple(
            f"tests/benchmark/running/test_{name}"
            for name in ("schedule", "times", "workers", "cluster")
        ),
    ),
    "files": (
        ("files/", "survey_data/table_records", "survey_data/json_data"),
        ("tests/files/",),
    ),
    "survey importing and additions": (
        ("survey_data/importing/", "survey_data/additions/"),
        ("tests/survey_data/importing/", "tests/survey_data/additions/"),
    ),
    "deposit: upload": (
        ("api/deposit/archives/",),
        ("tests/api/deposit/standin", "tests/api/deposit/test_deposit_upload"),
    ),
    "HTTP machinery": (
        ("api/web/", "api/server/", "api/http/openapi"),
        (
            *("tests/api/server/", "tests/api/http/test_http_machinery"),
            "tests/api/browser/test_page_reference",
        ),
    ),
    "docs and guide": (("api/docs/", "api/guide/"), ("tests/api/docs/", "tests/api/guide/")),
    "command line: layout": (
        tuple(
            f"api/cli/{name}"
            for name in (
                "options",
                "table_output",
                "wrong_call",
                "completion",
                "refusals",
            )
        ),
        ("tests/api/cli/test_cli_tables", "tests/api/cli/test_cli_completion"),
    ),
}


def code_lines(source: str) -> int:
    """Return how many lines of a module hold code."""
    lines = set()
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type not in _SILENT and token.string.strip():
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[0] if node.body else None
            if (
                isinstance(first, ast.Expr)
                and isinstance(first.value, ast.Constant)
                and isinstance(first.value.value, str)
            ):
                lines.difference_update(range(first.lineno, (first.end_lineno or 0) + 1))
    return len(lines)


def measured() -> dict[str, tuple[int, int]]:
    """Return lines and lines of code of every Python file that git knows, by path."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "*.py"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    found = {}
    for name in filter(None, listed.stdout.split("\0")):
        path = ROOT / name
        if path.is_file():
            source = path.read_text("utf-8")
            found[name] = len(source.splitlines()), code_lines(source)
    return found


def main() -> None:
    """Print a table."""
    sizes = measured()

    def told(name: str, within: tuple[str, ...]) -> str:
        chosen = [sizes[path] for path in sizes if path.startswith(within)]
        lines, code = (sum(one[at] for one in chosen) for at in (0, 1))
        return f"{name:<34}{len(chosen):>7}{lines:>9}{code:>9}\n"

    sys.stdout.write(f"{'':<34}{'files':>7}{'lines':>9}{'code':>9}\n")
    outside = tuple({path.split("/")[0] + "/" for path in sizes if "/" in path} - {"tests/"})
    sys.stdout.write(told("outside tests", outside) + told("tests", ("tests/",)))
    for folder in sorted(outside):
        sys.stdout.write(told(f"  {folder}", (folder,)))
    for part, (code, tests) in PARTS.items():
        sys.stdout.write("\n" + told(part, code) + told("  its tests", tests))


if __name__ == "__main__":
    main()
