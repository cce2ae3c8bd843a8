"""How tables choose their settings: on one coarse enough to be solved, of what samples settle."""

from __future__ import annotations

from types import ModuleType
from typing import Any

import numpy as np
import pytest

from algorithms.angles import separation_deg, sun_from_angles
from algorithms.contract import Floats
from algorithms.models.lut import blended_polynomials, lookup_table
from algorithms.models.lut.blended_polynomials import BlendedPolynomials
from algorithms.models.lut.error_tables import SMOOTHINGS
from algorithms.models.lut.lookup_table import ErrorTable

TABLE: dict[str, Any] = {"focal_length_mm": 2.0, "unit_mm": 0.01, "interval_deg": 2.5}


def calibration(alpha: Floats, beta: Floats) -> tuple[Floats, Floats]:
    """Spots of a grid of Suns, px from the middle, each coordinate bent by itself, and the Suns."""
    angles = np.stack(np.meshgrid(alpha, beta, indexing="ij"), axis=-1).reshape(-1, 2)
    sun = sun_from_angles(angles)
    tangents = sun[:, :2] / sun[:, 2:]
    return 200.0 * tangents * (1.0 + 0.05 * tangents**2), sun


def sizes_tried(monkeypatch: pytest.MonkeyPatch, module: ModuleType) -> list[int]:
    """Unknowns of every table that settings are compared on, as they are solved."""
    sizes: list[int] = []
    compare = module.errors_left_out

    def compared(design: Any, *given: Any) -> Floats:
        sizes.append(design.shape[1])
        found: Floats = compare(design, *given)
        return found

    monkeypatch.setattr(module, "errors_left_out", compared)
    return sizes


EVEN = np.linspace(-20.0, 20.0, 17)


def test_smoothing_is_chosen_on_a_table_that_can_be_solved_as_a_band(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spots, sun = calibration(EVEN, EVEN)
    sizes = sizes_tried(monkeypatch, lookup_table)
    ErrorTable(**TABLE).fit(spots, sun)
    assert sizes == [19 * 19]
    monkeypatch.setattr(lookup_table, "MAX_BAND", int(100**1.5))
    model = ErrorTable(**TABLE).fit(spots, sun)
    assert sizes[1:] == [7 * 7]  # of 10 degrees; those of 2.5 and 5 have more than 100 nodes
    assert model.table_deg_.shape == (19, 19, 2), "the table itself is as fine as asked for"
    assert model.smoothing_ in SMOOTHINGS
    assert separation_deg(model.predict(spots), sun).max() < 0.01


def test_degrees_that_samples_do_not_settle_are_not_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    spots, sun = calibration(EVEN, np.linspace(-20.0, 20.0, 6))
    sizes = sizes_tried(monkeypatch, blended_polynomials)
    model = BlendedPolynomials(**TABLE, smoothing=0.1).fit(spots, sun)
    assert sizes == [19 * terms for terms in (3, 5)]  # six places a row leave degree 6 open
    assert model.settings()["degree"] in {2, 4}
