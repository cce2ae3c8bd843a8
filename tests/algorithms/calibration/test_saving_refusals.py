"""Calibrations that cannot be written or read, and files of processes that may still be running."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from algorithms.calibration import documents
from algorithms.calibration.documents import DocumentError, digest_of, read_document
from algorithms.calibration.saving import (
    UnreadableCalibrationError,
    document,
    pipeline_of,
    stage_document,
)
from algorithms.contract import AboutExtractor, Extractor, FeatureKind, Floats, Observation
from algorithms.extractors.frames.centroid import BasicCentroid
from algorithms.models.geometric.standard_projection import StandardProjection
from algorithms.pipeline import Pipeline


@dataclass(frozen=True)
class Holding(Extractor):
    """Has one parameter of any kind."""

    about: ClassVar = AboutExtractor(
        name="holding", taxonomy="None", observation=Observation.FRAMES, kind=FeatureKind.SPOT
    )
    held: Any

    def extract(self, observations: Any) -> Floats:
        return np.zeros((len(observations), 2))


@pytest.fixture
def pipeline() -> Pipeline:
    model = StandardProjection(focal_length_mm=2.0, unit_mm=0.01)
    return Pipeline(BasicCentroid(), model.fit([[0.0, 0.0]], [[0.0, 0.0, 1.0]]))


@pytest.mark.parametrize("held", [{1.0, 2.0}, 1j, b"bytes", object()])
def test_a_parameter_that_is_no_number_text_or_table_is_refused(held: object) -> None:
    with pytest.raises(TypeError, match=f"numbers, text and tables.*{type(held).__name__}"):
        stage_document(Holding(held))


def test_a_list_that_does_not_name_its_kind_is_refused(pipeline: Pipeline) -> None:
    stored = json.loads(json.dumps(document(pipeline)))
    stored["extractor"]["parameters"]["window_px"] = [9]
    stored["digest"] = digest_of(stored)
    with pytest.raises(UnreadableCalibrationError, match="damaged: a bare list"):
        pipeline_of(stored)


def nested(depth: int) -> Any:
    value: Any = 1
    for level in range(depth):
        value = [value] if level % 2 else {"inner": value}
    return value


def test_a_file_may_be_fifty_levels_deep_and_no_deeper(tmp_path: Path) -> None:
    path = tmp_path / "deep.json"
    path.write_text(json.dumps(nested(50)))
    assert read_document(path) == nested(50)
    path.write_text(json.dumps(nested(51)))
    with pytest.raises(DocumentError, match="nested deeper than 50"):
        read_document(path)


def test_a_file_may_be_as_large_as_the_limit_and_no_larger(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "large.json"
    path.write_text("[1, 2]")
    monkeypatch.setattr(documents, "LARGEST_BYTES", 6)
    assert read_document(path) == [1, 2]
    monkeypatch.setattr(documents, "LARGEST_BYTES", 5)
    with pytest.raises(DocumentError, match="at most 5 bytes, got more"):
        read_document(path)


@pytest.mark.parametrize(
    ("forged", "said"),
    [
        (
            {"focal_length_mm": 1e29},
            "expected a number of at most 1e.20, got 1e.29 .spm, focal_length_mm",
        ),
        ({"focal_length_mm": True}, "expected a number, got True .spm, focal_length_mm"),
    ],
)
def test_a_forged_number_is_refused_by_name(
    pipeline: Pipeline, forged: dict[str, Any], said: str
) -> None:
    """With a digest that fits: who forges a document can compute it."""
    stored = json.loads(json.dumps(document(pipeline)))
    stored["model"]["parameters"].update(forged)
    stored["digest"] = digest_of(stored)
    with pytest.raises(UnreadableCalibrationError, match=said):
        pipeline_of(stored)


@pytest.mark.parametrize("entry", [True, "1", 1e29, None])
def test_a_forged_entry_of_an_array_is_refused_by_name(pipeline: Pipeline, entry: object) -> None:
    stored = json.loads(json.dumps(document(pipeline)))
    array = {"array": [0.5, entry], "shape": [2], "dtype": "f8"}
    stored["model"]["parameters"]["focal_length_mm"] = array
    stored["digest"] = digest_of(stored)
    with pytest.raises(UnreadableCalibrationError, match=r"expected .* .spm, focal_length_mm"):
        pipeline_of(stored)
