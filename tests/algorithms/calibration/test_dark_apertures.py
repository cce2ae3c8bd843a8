"""Apertures of a coded mask of which no spot is seen, counted one by one."""

import numpy as np
import pytest

from algorithms.calibration.coded.identity_kernel import find_dark
from algorithms.calibration.coded.table import code_of

COLUMNS, ROWS, MARGIN = 100.0, 80.0, 3.0


@pytest.mark.parametrize("at", [(50.0, 40.0), (20.3, 0.4), (88.0, -35.0), (0.2, 79.0)])
def test_every_aperture_in_view_without_a_spot_is_dark(at):
    """Wherever the mask's middle falls: also beside the view, and near its first row."""
    across = np.arange(-60.0, 61.0, 10.0)
    places = np.column_stack([axis.ravel() for axis in np.meshgrid(across, across)])
    code, _ = code_of(places, np.ones(len(places)), 25.0, 1.0, np.inf)
    fallen = code[0][:, :2] + at
    seen = ((fallen >= MARGIN) & (fallen <= (COLUMNS - 1 - MARGIN, ROWS - 1 - MARGIN))).all(axis=1)
    partners = np.flatnonzero(seen)[::3]  # every third has its spot
    view = np.array([COLUMNS, ROWS, 0.0, 0.0, 1.0, MARGIN, 0.0])
    given = (len(partners), np.array([*at, 0.0]), len(places), code, view, partners)
    assert seen.sum() > 10
    assert find_dark.py_func(*given) == seen.sum() - len(partners)
