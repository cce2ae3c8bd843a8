"""What is read of a coded mask, and its drawing as kernels take it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats


class CodeReading(NamedTuple):
    """What lists of spots (N, 3 K) say of a mask of A apertures.

    Attributes
    ----------
    displacement
        (N, 2) px of the mask's middle on the detector; NaN where the code is not read.
    apertures
        (N, K) the aperture of each spot that was used; -1 for the others.
    ambiguous
        (N,) whether several places of the mask explain the spots.
    """

    displacement: Floats
    apertures: NDArray[np.int64]
    ambiguous: NDArray[np.bool_]


class MaskDrawing(NamedTuple):
    """A mask's drawing as the kernels take it."""

    places: Floats  # (A, 2)
    widths: Floats  # (A,)
    reach: float
    tolerance: float
    widest: float
    view: Floats  # (7,)
    noise: tuple[float, ...]
