"""Sun vectors from a satellite's own solar panels: normals weighted by currents (Solar panel)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.drawn import DrawnModel
from algorithms.contract import AboutModel, FeatureKind, Floats
from algorithms.documented import documented
from algorithms.models.geometric.detector_faces import Normals, require_square_pairs, row_sums
from algorithms.row_arithmetic import normalise


@documented
@dataclass
class SolarPanels(DrawnModel):
    """Sum of the lit panels' normals, each weighted by its current, scaled to length one.

    On a body with panels square to each other every current is a component of the Sun vector, so
    the satellite's power supply doubles as its coarse Sun sensor. Light that reaches both panels
    of a pair alike cancels.

    Parameters
    ----------
    face_normals : tuple of six vectors
        Unit normals of the panels in the order of the features: three pairs of opposite ones,
        the pairs square to each other, in any order and turned any way.

    Notes
    -----
    Implements: eq:msfsc (model:solarpanel, Nurgizat2021): ``n = sum_i n_i I_i / sqrt(sum_i I_i^2)``
    over lit panels. The survey prints ``sum_i n_i I_0 / sum_i I_i^2``; corrected because that ratio
    has a unit and no panel's direction weighs more than another's. The corrected sum is a unit
    vector if one panel of each pair is lit; if stray light or albedo lights both, it is scaled to
    length one. A panel counts as lit if its signal is positive.

    Shapes: signals (N, 6), in any common unit, to unit vectors (N, 3), all directions.

    Failure: a NaN row for a NaN feature row, or where no signal is positive, or opposite ones
    cancel. Albedo is not distinguished from sunlight, and differences between the panels are not
    corrected.

    Cost: 40 operations and one root per sample.

    Examples
    --------
    >>> panels = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
    >>> currents = [[0.3, 0.0, 0.0, 0.0, 0.4, 0.0]]
    >>> SolarPanels(panels).fit(currents, [[0.6, 0.0, 0.8]]).predict(currents).round(3)
    array([[0.6, 0. , 0.8]])
    """

    about: ClassVar = AboutModel(
        name="solar-panel",
        taxonomy="Solar panel",
        studies=("Nurgizat2021",),
        labels=("model:solarpanel", "eq:msfsc"),
        origin="survey",
        needs=("face_normals",),
        accepts=frozenset({FeatureKind.SIGNALS}),
    )

    face_normals: Normals

    frontal: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        self._normals()

    def columns(self) -> int:
        """Six panels."""
        return 6

    def answer(self, features: Floats, context: Columns) -> Floats:
        """Directions (N, 3) of signals (N, 6)."""
        del context
        lit = np.maximum(features, 0.0)
        return normalise(np.column_stack([row_sums(lit, n) for n in self._normals().T]))

    def _normals(self) -> Floats:
        """(6, 3) normals, or UnsuitableDesignError unless they are three square pairs."""
        return require_square_pairs(self.face_normals, self.about.name)
