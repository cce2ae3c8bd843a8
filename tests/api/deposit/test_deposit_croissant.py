"""Croissant documents of the bundle, read by MLCommons' own library."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import mlcroissant
import numpy as np
import pandas as pd
import pytest

from api.deposit.bundle import Bundle
from api.metadata.codemeta import NAME, codemeta_text
from api.metadata.identity import identity
from files.checksums import sha256

#: The library warns of packages that it reads other formats with.
pytestmark = pytest.mark.filterwarnings("ignore::Warning:mlcroissant", "ignore::Warning:rdflib")


def read(path: Path) -> mlcroissant.Dataset:
    """Read and validate a document; errors raise, and there are no warnings."""
    found = mlcroissant.Dataset(jsonld=str(path))
    issues = found.metadata.ctx.issues
    assert (issues.errors, issues.warnings) == (set(), set())
    return found


def records(dataset: mlcroissant.Dataset, table: str) -> list[dict[str, object]]:
    found = list(dataset.records(record_set=table))
    return [{k.removeprefix(f"{table}/"): v for k, v in row.items()} for row in found]


@pytest.mark.slow
def test_every_document_is_valid_and_names_files_as_they_are(built: Bundle) -> None:
    folder = built.directory / "croissant"
    paths = sorted(folder.iterdir())
    assert {path.stem for path in paths} > {"record", "survey", "pd-slit"}
    for path in paths:
        document = json.loads(path.read_text("utf-8"))
        read(path)
        assert document["distribution"], path.name
        for file in document["distribution"]:
            there = folder / file["contentUrl"]
            assert file["sha256"] == sha256(there), file["contentUrl"]
            assert file["contentSize"] == f"{there.stat().st_size} B"


@pytest.mark.slow
def test_the_record_is_loaded_with_its_types(built: Bundle) -> None:
    dataset = read(built.directory / "croissant" / "record.json")
    document = json.loads((built.directory / "croissant" / "record.json").read_text("utf-8"))
    every = {table["@id"] for table in document["recordSet"]}
    assert {"leaderboard", "scores", "curves", "claim_verdicts"} < every
    rows = records(dataset, "leaderboard")
    with (built.directory / "benchmark" / "leaderboard.csv").open(newline="") as file:
        texts = list(csv.DictReader(file))
    assert len(rows) == len(texts)
    for row, text in zip(rows[:500], texts[:500], strict=True):
        assert row["extractor"] == text["extractor"].encode()
        assert row["tied"] is (text["tied"] == "true")
        assert (row["rank"] is None) == (text["rank"] == "")
        assert row["rank"] is None or row["rank"] == int(text["rank"])
        assert row["own_deg"] is None or row["own_deg"] == float(text["own_deg"])


def test_the_survey_s_none_is_a_value_and_unknown_is_none(built: Bundle) -> None:
    rows = records(read(built.directory / "croissant" / "survey.json"), "attributes")
    values = {(r["study"].decode(), r["attribute"].decode()): r["value"] for r in rows}
    assert values["Coutinho2022", "model"] == b"None"
    assert None in values.values()


@pytest.mark.slow
def test_samples_of_a_data_set_are_loaded_as_numbers(built: Bundle) -> None:
    path = built.directory / "croissant" / "pd-slit.json"
    dataset = read(path)
    errors = records(dataset, "errors")
    published = pd.read_parquet(built.directory / "benchmark" / "samples" / "pd-slit.parquet")
    assert len(errors) == len(published)
    for row, (_, known) in zip(errors[:200], published.head(200).iterrows(), strict=True):
        assert (row["extractor"].decode(), row["sample"]) == (known["extractor"], known["sample"])
        missing = math.isnan(known["error_deg"])
        assert row["error_deg"] == (None if missing else float(known["error_deg"]))
    calibration = records(dataset, "calibration")
    samples = np.load(built.directory / "frames" / "pd-slit" / "nominal" / "calibration.npz")
    assert len(calibration) == len(samples["sun"])
    assert [calibration[3][f"sun_{axis}"] for axis in "xyz"] == samples["sun"][3].tolist()


def test_the_bundle_has_codemeta_of_the_code_it_comes_of(built: Bundle) -> None:
    assert (built.directory / NAME).read_text("utf-8") == codemeta_text(identity().citation)
