"""Polynomials of channels for flight answer what the chain does, or say why there are none."""

from __future__ import annotations

from types import SimpleNamespace

import bench
import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from api.calibrate.flight.channels import ChannelTable, channel_table
from api.calibrate.flight.table import NoTableError

Array = NDArray[np.float64]
SPHERE = bench.sphere(600, 1)


class Cells:
    """A chain of cells whose signals are two and the cosine, without noise."""

    def __init__(self, count: int, *context: str) -> None:
        self.normals = bench.sphere(count, 7)
        self.about = SimpleNamespace(context=context)

    def signals(self, sun: Array) -> Array:
        return np.asarray(2.0 + sun @ self.normals.T)

    def predict(self, signals: Array, _: object = None) -> Array:
        sun = (signals - 2.0) @ np.linalg.pinv(self.normals.T)
        return np.asarray(sun / np.linalg.norm(sun, axis=1)[:, None])


def table_of(cells: Cells, sun: Array, most_deg: float = 3.0) -> ChannelTable:
    return channel_table(cells, cells.signals(sun), {}, most_deg)  # type: ignore[arg-type]


@pytest.mark.parametrize(("count", "terms"), [(6, 1 + 6 + 21), (12, 1 + 12)])
def test_products_of_signals_are_terms_of_few_channels_only(count: int, terms: int) -> None:
    cells = Cells(count)
    found = table_of(cells, SPHERE)
    assert found.words == f"{terms} terms in each of 8 octants"
    fresh = bench.sphere(200, 3)
    off = separation_deg(found.predict(cells.signals(fresh)), fresh)
    assert np.isfinite(off).mean() > 0.9
    assert np.sqrt(np.nanmean(off**2)) < 3.0
    assert found.added_deg <= 3.0


def test_octants_without_samples_are_not_answered() -> None:
    cells = Cells(6)
    above = SPHERE[SPHERE[:, 2] > 0.3]
    found = table_of(cells, above)
    assert 0 < found.used.sum() < 8
    answered = np.isfinite(found.predict(cells.signals(SPHERE))[:, 0])
    assert answered[SPHERE[:, 2] > 0.3].mean() > 0.9
    assert not answered[SPHERE[:, 2] < -0.5].any()


@pytest.mark.parametrize(
    ("cells", "samples", "most_deg", "said"),
    [
        (Cells(6, "temperature_K"), 600, 3.0, "code for flight knows no temperature_K"),
        (Cells(17), 600, 3.0, "at most 16 channels; got 17"),
        (Cells(12), 600, 1e-9, "depart from the chain by .* deg, more than it errs"),
        (Cells(6), 11, 3.0, "no polynomial of the channels fits the chain's answers"),
    ],
    ids=["temperature", "17 channels", "less error than asked", "eleven samples"],
)
def test_a_chain_that_no_polynomials_can_stand_for_is_refused(
    cells: Cells, samples: int, most_deg: float, said: str
) -> None:
    with pytest.raises(NoTableError, match=said):
        table_of(cells, SPHERE[:samples], most_deg)
