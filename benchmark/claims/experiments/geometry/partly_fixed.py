"""`PartlyFixedModel`: a model of which some parameters are fitted and the others stay as drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from algorithms.calibration.calibrated import Columns
from algorithms.calibration.parametric import FreeParameter, ParametricModel
from algorithms.contract import Floats


@dataclass
class PartlyFixedModel(ParametricModel):
    """A parametric model with only the parameters named `free` fitted.

    The others keep the values that the model's own fit starts from, which are its drawing's.

    `model` is made for the sensor, unfitted; `free` are names of its parameters, none leaves the
    drawing. ValueError for a name that is no parameter of the model.
    """

    about: ClassVar[Any] = None  # the model's, set in every instance

    model: ParametricModel
    free: tuple[str, ...]

    base_: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        vars(self)["about"] = self.model.about
        super().__post_init__()
        known = [one.name for one in self.model.free_parameters()]
        if odd := sorted(set(self.free) - set(known)):
            raise ValueError(f"free must name parameters among {', '.join(known)}; got {odd}")

    def columns(self) -> int:
        """As the model's."""
        return self.model.columns()

    def free_parameters(self) -> Sequence[FreeParameter]:
        """Those of the model that are free."""
        return [one for one in self.model.free_parameters() if one.name in self.free]

    def starts(self, features: Floats, sun: Floats, context: Columns) -> Sequence[Sequence[float]]:
        """Where the model starts."""
        places = self._free()
        return [
            [value for value, at in zip(start, places, strict=True) if at]
            for start in self.model.starts(features, sun, context)
        ]

    def learn(self, features: Floats, sun: Floats, context: Columns) -> None:
        """Fit the free ones."""
        self.base_ = np.array(self.model.starts(features, sun, context)[0], dtype=np.float64)
        if self.free:
            super().learn(features, sun, context)
            return
        self.vector_, self.covariance_, self.condition_ = np.empty(0), np.empty((0, 0)), 1.0

    def residuals(
        self,
        vector: Floats,
        features: Floats,
        sun: Floats,
        axes: tuple[Floats, Floats],
        context: Columns,
    ) -> Floats:
        """(n, 2) as the model's."""
        return self.model.residuals(self._whole(vector), features, sun, axes, context)

    def directions(self, vector: Floats, features: Floats, context: Columns) -> Floats:
        """(N, 3) as the model's."""
        return self.model.directions(self._whole(vector), features, context)

    def _free(self) -> list[bool]:
        return [one.name in self.free for one in self.model.free_parameters()]

    def _whole(self, vector: Floats) -> Floats:
        whole = self.base_.copy()
        whole[self._free()] = vector
        return whole
