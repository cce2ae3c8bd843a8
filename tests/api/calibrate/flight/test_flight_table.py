"""A table for flight answers what the chain does inside its hull, or says why there is none."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from api.calibrate.flight.table import WANTED_DEG, NoTableError, flight_table

Array = NDArray[np.float64]


class Formula:
    """A fitted chain that is a formula, defined where this gives numbers."""

    def __init__(self, sun: Callable[[Array], Array], *context: str) -> None:
        self.sun = sun
        self.about = SimpleNamespace(context=context)

    def predict(self, features: Array, _: object = None) -> Array:
        return self.sun(features)


def cosines(features: Array) -> Array:
    """The features are s_x and s_y; NaN where no direction has these."""
    square = (features**2).sum(axis=1)
    up = np.sqrt(np.where(square < 1.0, 1.0 - square, np.nan))
    return np.column_stack([np.where(square[:, None] < 1.0, features, np.nan), up])


def rippled(features: Array) -> Array:
    """Cosines with a ripple finer than any grid of nodes."""
    return cosines(features + 1e-3 * np.sin(400.0 * features))


def nowhere(features: Array) -> Array:
    return np.full((len(features), 3), np.nan)


def disc(radius: float, count: int = 400) -> Array:
    """Features over a disc, a ring of 200 at its edge among them."""
    drawn = np.random.default_rng(1).uniform(-radius, radius, (count, 2))
    inside = drawn[np.linalg.norm(drawn, axis=1) < radius]
    around = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
    ring = radius * np.column_stack([np.cos(around), np.sin(around)])
    return np.vstack([inside, ring])


def table_of(model: Any, features: Array) -> Any:
    return flight_table(model, features, {})


def test_a_smooth_chain_is_answered_to_a_thousandth_of_a_degree() -> None:
    features = disc(0.7)
    found = table_of(Formula(cosines), features)
    assert found.largest_deg <= WANTED_DEG
    off = separation_deg(found.predict(features), cosines(features))
    assert np.max(off) <= WANTED_DEG
    assert np.isnan(found.predict(np.array([[0.9, 0.0], [np.nan, 0.0]]))).all()


def test_a_hull_of_many_sides_becomes_one_of_48_that_holds_every_sample() -> None:
    features = disc(0.7)
    found = table_of(Formula(cosines), features)
    assert found.sides.shape == (48, 3)
    assert np.isfinite(found.predict(features)).all()


def test_nodes_where_the_chain_has_no_answer_do_not_spoil_those_where_it_has() -> None:
    features = disc(0.97)  # the corners of the grid lie where no direction is
    found = table_of(Formula(cosines), features)
    assert np.isnan(cosines(np.array([found.low]))).all()
    assert np.isfinite(found.nodes).all()
    inner = features[np.linalg.norm(features, axis=1) < 0.8]
    off = separation_deg(found.predict(inner), cosines(inner))
    assert np.max(off) < 0.02


def test_a_chain_that_no_table_follows_gets_the_largest_and_its_error_is_stated() -> None:
    features = disc(0.7)
    found = table_of(Formula(rippled), features)
    assert found.nodes.shape == (65, 65, 2)
    assert found.words == "a table of 65 by 65 nodes"
    # an amplitude of 1e-3 an axis that the table cannot follow
    assert 0.02 < found.added_deg < 0.2
    assert found.largest_deg > WANTED_DEG


@pytest.mark.parametrize(
    ("model", "columns", "said"),
    [
        (Formula(cosines), 3, "sensors of two features; this one has 3"),
        (Formula(cosines, "temperature_K"), 2, "code for flight knows no temperature_K"),
        (Formula(nowhere), 2, "the chain answers nowhere inside its hull"),
    ],
)
def test_a_chain_that_no_table_can_stand_for_is_refused(
    model: Formula, columns: int, said: str
) -> None:
    features = np.column_stack([disc(0.5), np.zeros(len(disc(0.5)))])[:, :columns]
    with pytest.raises(NoTableError, match=said):
        table_of(model, features)
