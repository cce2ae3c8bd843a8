"""A calibrated sensor as steps with constants, from raw readings to a direction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.contract import Floats
from calibrate.flight import runtime, runtime_faces


class NoCodeError(ValueError):
    """A calibration that no flight code can stand for; the message says why."""


@dataclass(frozen=True)
class Step:
    """One step of a program: the function of this name in `runtime` and in the C templates.

    Attributes
    ----------
    name : str
    constants : mapping of str to number or ndarray
        Integers become C enumerators in capitals, the rest constants of the same name.
    operations : int
        Most additions, multiplications, divisions and comparisons of real numbers.
    calls : int
        Most calls of the mathematics library.
    """

    name: str
    constants: Mapping[str, Any]
    operations: int
    calls: int = 0


@dataclass(frozen=True)
class Thermometer:
    """A file's temperature: kelvin are ``scale * value + offset``."""

    column: str
    unit: str
    scale: float
    offset: float

    def value(self, kelvin: Floats) -> Floats:
        """Return temperatures (N,) as the file has them."""
        return np.asarray((kelvin - self.offset) / self.scale)


@dataclass(frozen=True)
class Program:
    """All steps of a sensor.

    Attributes
    ----------
    columns : tuple of str
        Of the raw readings, in the file's order.
    steps : tuple of Step
        In order; each but the last few reads what the one before left.
    thermometer : Thermometer or None
        None where no temperature is read.
    words : str
        What stands for the model, for a report.
    """

    columns: tuple[str, ...]
    steps: tuple[Step, ...]
    thermometer: Thermometer | None
    words: str

    @property
    def operations(self) -> int:
        """Most operations of an answer, those of its angles and its 1-sigma among them."""
        return sum(step.operations for step in self.steps) + _OF_ANSWER

    @property
    def calls(self) -> int:
        """Most calls of the mathematics library of an answer."""
        return sum(step.calls for step in self.steps) + _CALLS_OF_ANSWER

    @property
    def bytes(self) -> int:
        """Size of the constants in double precision."""
        return 8 * sum(np.size(value) for step in self.steps for value in step.constants.values())


#: Of angles and 1-sigma, counted in the C code; a ring's search is of at most twelve.
_OF_ANSWER, _CALLS_OF_ANSWER = 110, 7


def step_functions() -> dict[str, Callable[..., Any]]:
    """Return the function of each step by its name."""
    return {
        name: function
        for module in (runtime, runtime_faces)
        for name, function in vars(module).items()
        if callable(function) and getattr(function, "__module__", "") == module.__name__
    }


def run(
    steps: tuple[Step, ...], values: Floats, kelvin: Floats | None = None
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Run steps on rows of values.

    Parameters
    ----------
    steps : tuple of Step
    values : ndarray, shape (N, K)
    kelvin : ndarray, shape (N,), optional

    Returns
    -------
    values : ndarray, shape (N, F)
        What the last step left.
    sun : ndarray, shape (N, 3)
        Unit vectors; NaN where the status is not 0.
    status : ndarray of int, shape (N,)
        The first that is not 0.
    """
    functions = step_functions()
    sun = np.full((len(values), 3), np.nan)
    warm = np.zeros(len(values)) if kelvin is None else kelvin
    status = np.zeros(len(values), dtype=np.int64)
    with np.errstate(all="ignore"):
        for step in steps:
            values, sun, found = functions[step.name](values, sun, warm, step.constants)
            status = np.where(status == 0, found, status)
    sun = np.array(sun, dtype=np.float64)
    sun[status != 0] = np.nan
    return values, sun, status
