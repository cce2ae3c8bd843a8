"""Errors of samples that a fit did not see: those compared on, the rim's, and those removed."""

from __future__ import annotations

import numpy as np

from algorithms.chain import Scored
from algorithms.contract import Floats, Model, SensorGeometry, UnusableDataError
from calibrate.readings import Readings
from calibrate.selection import Candidate, fitted, fold_of
from calibrate.uncertainty import parts_of

#: Parts of the rim that are left out one after the other.
_PARTS = 3


def errors_left_out(  # noqa: PLR0917 - what was fitted, and to what
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry, model: Model,
    removed: Readings,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return errors (M, 3) of samples that a fit did not see, and their true directions (M, 3).

    Samples that the model's own residual removed count as others do: no neighbour contradicts them,
    so that new ones may err as much.

    Parameters
    ----------
    scored : Scored
        The model that was chosen.
    chosen : Candidate
        What it did on the samples compared on.
    used : Readings
        These samples.
    geometry : SensorGeometry
    model : Model
        The final fit.
    removed : Readings
        Samples removed because the model does not explain them, all of them.

    Returns
    -------
    ndarray, ndarray
        Predicted minus true direction, NaN where not answered, and the true direction.
    """
    offsets = _with_rim(scored, chosen, used, geometry)
    if not len(removed):
        return offsets, used.sun
    beside = model.predict(removed.features, removed.context) - removed.sun
    return np.vstack([offsets, beside]), np.vstack([used.sun, removed.sun])


def _with_rim(
    scored: Scored, chosen: Candidate, used: Readings, geometry: SensorGeometry
) -> Floats:
    """Return predicted minus true direction (N, 3) of every sample when it was left out.

    Models are compared without the rim of the field, to which no fit should be continued. But
    errors are largest there: a third of the rim's poses is left out at a time, so that its
    neighbours on the rim stay.
    """
    offsets = np.array(chosen.offsets)
    rim = np.flatnonzero(fold_of(used)[0] < 0)
    part = parts_of(used.sun[rim], _PARTS)
    for number in range(_PARTS):
        out = rim[part == number]
        if not len(out):
            continue
        try:
            model = fitted(scored, used.only(np.setdiff1d(np.arange(len(used)), out)), geometry)
        except UnusableDataError:
            continue
        test = used.only(out)
        offsets[out] = model.predict(test.features, test.context) - test.sun
    return offsets
