"""The survey's tables, read by the csv module alone, as sets of studies."""

from __future__ import annotations

import csv
from collections import defaultdict
from pathlib import Path

import pytest

import survey_data

TABLES = Path(survey_data.__file__).parent
Values = dict[str, dict[str, set[str]]]


def read(name: str) -> list[dict[str, str]]:
    with (TABLES / f"{name}.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.fixture(scope="module")
def values() -> Values:
    """Study -> level -> values."""
    found: Values = {row["key"]: defaultdict(set) for row in read("studies")}
    category = {(r["attribute"], r["value"]): r["category"] for r in read("taxonomy")}
    ring = {row["model"]: row["calibration"] for row in read("model_families")}
    for row in read("attributes"):
        attribute, value = row["attribute"], row["value"]
        if not value:
            continue
        of = found[row["study"]]
        of[attribute].add(value)
        if attribute == "model":
            of["model_category"].add(category["model", value])
            of["calibration"].add("None" if value == "None" else ring.get(value, "offline"))
        if attribute == "extractor":
            of["extractor_family"].add(category["extractor", value])
    return found


@pytest.fixture(scope="module")
def sensors() -> dict[str, set[tuple[str, str]]]:
    """Study with several sensors -> detector and mask of each."""
    found: dict[str, set[tuple[str, str]]] = defaultdict(set)
    for row in read("architectures"):
        found[row["study"]].add((row["detector"], row["mask"]))
    return found


def studies_with(
    values: Values,
    sensors: dict[str, set[tuple[str, str]]],
    one: tuple[str, str],
    other: tuple[str, str],
) -> set[str]:
    """Studies with both values, on one sensor where detector and mask are meant."""
    keys = {k for k, of in values.items() if one[1] in of[one[0]] and other[1] in of[other[0]]}
    if {one[0], other[0]} != {"detector", "mask"}:
        return keys
    named = dict([one, other])
    pair = (named["detector"], named["mask"])
    return {key for key in keys if key not in sensors or pair in sensors[key]}
