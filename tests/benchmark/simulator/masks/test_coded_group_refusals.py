"""Masks of coded groups whose holes overlap, or whose codes could be mistaken, are refused."""

from __future__ import annotations

from typing import Any

import pytest

from benchmark.simulator.masks.coded_groups import oblique_coded, spacing_and_size_coded

ORDERS = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0), (0, 1, 2))


def coded(**changes: float) -> Any:
    given = {
        "pitch_mm": 2.0,
        "narrow_mm": 0.1,
        "wide_mm": 0.2,
        "first_mm": 0.5,
        "step_mm": 0.1,
        "focal_length_mm": 4.0,
    }
    return spacing_and_size_coded(4, **{**given, **changes})


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"narrow_mm": 0.2}, "narrow_mm must be below wide_mm; got 0.2 and 0.2"),
        ({"narrow_mm": 0.0}, "narrow_mm must be below wide_mm; got 0.0 and 0.2"),
        # the outermost group, 3 mm off along both axes, is seen under 47 deg: 1.2 times as wide
        ({"first_mm": 0.24}, r"exceed the largest diameter of 0\.24 mm; got 0\.24"),
        # spacings of 0.5 and 0.6 mm: a next one would be 0.7
        ({"pitch_mm": 1.25}, r"up to 0\.6 mm are ambiguous in cells of 1\.25 mm.*exceed 0\.7 mm"),
    ],
)
def test_sizes_and_spacings_that_cannot_be_told_apart_are_refused(
    changes: dict[str, float], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        coded(**changes)


@pytest.mark.parametrize(
    ("orders", "cell_mm", "message"),
    [
        (ORDERS[:6], 0.2, "seven, each of the same rows"),
        (((0, 1), *ORDERS[1:]), 0.2, "seven, each of the same rows"),
        (ORDERS, 0.2, "different orders of rows 0, 1, 2"),
        (tuple(tuple(2 * row for row in order) for order in ORDERS), 0.2, "rows 0, 1, 2 and so on"),
    ],
)
def test_orders_that_do_not_name_seven_groups_are_refused(
    orders: tuple[tuple[int, ...], ...], cell_mm: float, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        oblique_coded(orders, pitch_mm=2.0, cell_mm=cell_mm, diameter_mm=0.1)


def test_cells_as_wide_as_their_holes_are_refused() -> None:
    orders = [(*order, 3) for order in ORDERS[:6]] + [(3, 2, 1, 0)]
    assert len(oblique_coded(orders, pitch_mm=2.0, cell_mm=0.11, diameter_mm=0.1).apertures) == 28
    with pytest.raises(ValueError, match=r"exceed the diameter of 0\.1 mm; got 0\.1"):
        oblique_coded(orders, pitch_mm=2.0, cell_mm=0.1, diameter_mm=0.1)
