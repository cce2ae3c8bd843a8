"""Folders read as a table of contents: few files in each, and none too long to read in one go."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

ROOT = Path(__file__).parents[1]
CODE = ("files", "survey_data", "registry", "algorithms", "benchmark", "api", "tools", "tests")
SOURCE = {".py", ".js", ".css", ".html"}
MOST_FILES, MOST_LINES = 25, 400


def source() -> list[Path]:
    found = (path for floor in CODE for path in (ROOT / floor).rglob("*"))
    return [path for path in found if path.suffix in SOURCE and path.is_file()]


def test_a_folder_holds_few_files_but_for_the_data_sets() -> None:
    counted = Counter(path.parent.relative_to(ROOT).as_posix() for path in source())
    full = {folder for folder, files in counted.items() if files > MOST_FILES}
    assert full == {"benchmark/datasets/standard"}


def test_no_file_of_code_is_long() -> None:
    lines = {path: len(path.read_text(encoding="utf-8").splitlines()) for path in source()}
    assert len(lines) > 1000
    assert {p.relative_to(ROOT).as_posix(): n for p, n in lines.items() if n > MOST_LINES} == {}
