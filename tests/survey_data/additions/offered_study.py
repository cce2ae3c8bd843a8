"""A made-up study as its file offers it, and what comes of the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from survey_data.additions.offered import FaultsError, parse_toml, read_addition

STUDY = """\
key = "Doe2031a"
title = "A sun sensor that nobody built"
authors = ["Jane Doe", "Łukasz Müller"]
year = 2030
venue = "Journal of Made-up Sensors"
type = "thesis"
doi = "https://doi.org/10.1234/made.up"
identity = "confirmed"

[[model]]
value = "DNN"
name = "graph network"
nearest = true
role = "proposed"
basis = "full-text"
source = "https://arxiv.org/abs/2030.00001"
note = "chapter 3"

[[detector]]
value = "CMOS"
basis = "title"

[[mask]]
basis = "unknown"
note = "the text does not say"

[[accuracy_deg]]
value = 0.005
basis = "abstract"
source = "10.1234/made.up"
""".replace("2031a", "2030")

CONFIRMED = {"study": "Doe2030", "name": "Jane Doe", "date": "2030-02-28"}
CONFIRMED |= {"confirms": "every cell", "source": "https://example.org/letter"}


def content(folder: Path) -> dict[str, bytes]:
    """Every file of a folder, hidden ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


def offered(folder: Path, text: str = STUDY, name: str = "study.toml") -> Path:
    path = folder.parent / f"{folder.name}-{name}"
    path.write_text(text, encoding="utf-8")
    return path


def refused(text: str) -> list[tuple[int | None, str]]:
    with pytest.raises(FaultsError) as error:
        read_addition(parse_toml(text, "study.toml"))
    return [(fault.line, fault.message) for fault in error.value.faults]


def line_of(text: str, words: str) -> int:
    return text[: text.index(words)].count("\n") + 1
