"""How good a fit is: its residuals, its parameters with standard errors, what it was fitted to."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from algorithms.contract import Floats

Setting = int | float | str


@dataclass(frozen=True)
class Parameter:
    """A number that a fit settled, with its standard error.

    Parameters
    ----------
    name : str
        What it is.
    value : float
        Best estimate.
    deviation : float
        Standard error, from the residuals' own size.
    unit : str
        Of both; empty for a number without one.

    Examples
    --------
    >>> lowest, highest = Parameter("focal_length", 2.12, 0.01, "mm").interval()
    >>> round(lowest, 4), round(highest, 4)
    (2.1004, 2.1396)
    """

    name: str
    value: float
    deviation: float
    unit: str = ""

    def interval(self, quantile: float = 1.959963984540054) -> tuple[float, float]:
        """Interval of `quantile` standard errors to both sides; 95 % of a normal error's."""
        half = quantile * self.deviation
        return self.value - half, self.value + half


@dataclass(frozen=True)
class FitQuality:
    """What a fit says of itself; the attribute ``quality_`` of a fitted model.

    Parameters
    ----------
    samples : int
        Calibration samples with features.
    residual_rms_deg : float
        Root mean square of the angle between what the fitted model gives for them and the Sun.
    data_digest : str
        Of the samples: 32 hexadecimal digits of a SHA-256.
    condition : float, optional
        Of the equations, their columns brought to one length; None where nothing was solved.
    parameters : tuple of Parameter
        Those that have a name of their own; a table's nodes have none.
    settings : mapping of str to int, float or str
        Orders and smoothing that the calibration samples chose.
    validation_rms_deg : float, optional
        Root mean square angle on samples left out of the fit, where settings were chosen by it.

    Examples
    --------
    >>> quality = FitQuality(441, 0.01, "0" * 32, parameters=(Parameter("tilt", 0.2, 0.1, "deg"),))
    >>> quality.parameter("tilt").value
    0.2
    """

    samples: int
    residual_rms_deg: float
    data_digest: str
    condition: float | None = None
    parameters: tuple[Parameter, ...] = ()
    settings: Mapping[str, Setting] = field(default_factory=dict)
    validation_rms_deg: float | None = None

    def parameter(self, name: str) -> Parameter:
        """Return the parameter of that name; KeyError, naming those there are, otherwise."""
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        raise KeyError(f"no parameter {name}; there are {[p.name for p in self.parameters]}")


def data_digest(features: Floats, sun: Floats, context: Mapping[str, Floats]) -> str:
    """Digest of calibration samples: their numbers, shapes and names.

    Parameters
    ----------
    features : ndarray, shape (n, F)
        Finite.
    sun : ndarray, shape (n, 3)
        Unit vectors.
    context : mapping of str to ndarray
        Columns read beside them.

    Returns
    -------
    str
        32 hexadecimal digits of a SHA-256.

    Examples
    --------
    >>> data_digest(np.zeros((1, 2)), np.array([[0.0, 0.0, 1.0]]), {})
    'c9aba749cec95f450b79746ea4112e41'
    """
    state = hashlib.sha256()
    columns = {"features": features, "sun": sun}
    columns |= {name: context[name] for name in sorted(context)}
    for name, column in columns.items():
        state.update(f"{name} {column.shape}\n".encode())
        state.update(np.ascontiguousarray(column, dtype="<f8").tobytes())
    return state.hexdigest()[:32]
