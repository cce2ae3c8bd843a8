"""A calibrated sensor as steps with constants, from raw readings to a direction, and its tests."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import asdict, astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from calibrate.flight import runtime
from calibrate.forms.units import KELVIN


class NoCodeError(ValueError):
    """A calibration that no flight code can stand for; the message says why."""


@dataclass(frozen=True)
class Step:
    """One step of a program: the function of this name in `runtime` and in the C templates.

    Integers among the constants become C enumerators in capitals, the rest constants of the same
    name.
    """

    name: str
    constants: Mapping[str, Any]
    operations: int  # most additions, multiplications, divisions and comparisons
    calls: int = 0  # most calls of the mathematics library


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
    """All steps of a sensor."""

    columns: tuple[str, ...]  # of the raw readings, in the file's order
    steps: tuple[Step, ...]  # each reads what the one before left
    thermometer: Thermometer | None  # None where no temperature is read
    words: str  # what the code computes instead of the model, for a report

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
        for name, function in vars(runtime).items()
        if callable(function) and getattr(function, "__module__", "") == runtime.__name__
    }


def run(
    steps: tuple[Step, ...], values: Floats, kelvin: Floats | None = None
) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Run steps on rows (N, K): return values (N, F), directions (N, 3) and statuses (N,).

    Values are what the last step left; directions are NaN where the status, the first that is not
    0, says why.
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


_DAMAGED = (KeyError, TypeError, ValueError, AttributeError, OverflowError)
#: Of a stored program: steps, numbers of a constant, and the largest whole one, which loops run to.
_MOST_STEPS, _MOST_NUMBERS, _LARGEST_WHOLE = 20, 100_000, 500
#: A constant's name, which stands in C as it is.
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,30}")


def stored_program(program: Program) -> dict[str, Any]:
    """Return a program as what JSON can say."""
    steps = [
        {
            "name": step.name,
            "constants": {
                name: np.asarray(value).tolist() for name, value in step.constants.items()
            },
            "operations": step.operations,
            "calls": step.calls,
        }
        for step in program.steps
    ]
    thermometer = None if program.thermometer is None else asdict(program.thermometer)
    return {
        "columns": list(program.columns),
        "steps": steps,
        "thermometer": thermometer,
        "words": program.words,
    }


def program_of(stored: Mapping[str, Any] | None) -> Program:
    """Return the program that a document holds; NoCodeError if it holds none, or what is none."""
    if stored is None:
        raise NoCodeError(
            "the old document holds no program: no code was written with it, or it is older than "
            "programs in documents"
        )
    try:
        steps = tuple(
            Step(
                str(one["name"]),
                {name: _constant(name, value) for name, value in one["constants"].items()},
                int(one["operations"]),
                int(one["calls"]),
            )
            for one in stored["steps"]
        )
        measured = stored["thermometer"]
        thermometer = None if measured is None else Thermometer(**measured)
        columns = (*stored["columns"], *([thermometer.column] if thermometer else ()))
        if isinstance(stored["columns"], str) or not all(isinstance(c, str) for c in columns):
            raise TypeError(f"expected names of columns, got {stored['columns']!r:.60}")
        known = [(unit, *numbers) for unit, numbers in KELVIN.items()]
        if thermometer and astuple(thermometer)[1:] not in known:
            raise ValueError(f"expected a unit with its scale and offset, got {measured!a:.90}")
        if not stored["words"].isprintable():
            raise ValueError(f"expected words, got {stored['words']!a:.60}")
        made = Program(tuple(stored["columns"]), steps, thermometer, stored["words"])
    except _DAMAGED as error:
        raise NoCodeError(f"the old document's program is damaged: {error}") from error
    unknown = [step.name for step in steps if step.name not in step_functions()]
    if unknown or not 0 < len(steps) <= _MOST_STEPS or steps[0].name != "readings":
        raise NoCodeError(
            f"the old document's program is damaged: steps {unknown or 'missing'!r:.60}"
        )
    places = np.asarray(steps[0].constants.get("place", -1))
    if places.dtype.kind != "i" or sorted(places.flat) != list(range(len(made.columns))):
        raise NoCodeError(
            f"the old document's program is damaged: it has {len(made.columns)} columns"
        )
    return made


def _constant(name: str, value: Any) -> Any:
    """Return a constant; ValueError for what is no number of one, or a name that is none in C."""
    found = np.asarray(value)
    whole = found.dtype.kind == "i"
    if (
        not _NAME.fullmatch(name)
        or not (whole or (found.dtype.kind == "f" and np.isfinite(found).all()))
        or found.size > _MOST_NUMBERS
        or (whole and np.abs(found).max(initial=0) > _LARGEST_WHOLE)
    ):
        raise ValueError(f"expected the constants of a step, got {name!a:.60}: {value!a:.60}")
    return found if isinstance(value, list) else value


#: Rows with an answer.
_ROWS = 20
#: A reading that is none.
_NONE = 1e33


@dataclass(frozen=True)
class Vectors:
    """Raw readings in the file's order and what is expected of them."""

    values: Floats  # (V, K)
    temperature: Floats  # (V,), as the file has it
    sun: Floats  # (V, 3), of the model; NaN where the status is not 0
    status: NDArray[np.int64]
    largest_deg: float  # largest difference of the program from the model

    def __len__(self) -> int:
        return len(self.values)


def vectors_of(program: Program, raw: Floats, kelvin: Floats, model: Floats) -> Vectors:
    """Return raw rows of the calibration spread over the field, then rows that must be refused."""
    _, sun, status = run(program.steps, raw, kelvin)
    off = separation_deg(sun, model)
    known = np.flatnonzero((status == 0) & np.isfinite(off))
    chosen = known[_spread(model[known])]
    refused, warm = _refused(program, raw[chosen[0]], float(kelvin[chosen[0]]))
    _, nothing, stated = run(program.steps, refused, warm)
    warmth = np.concatenate([kelvin[chosen], warm])
    return Vectors(
        np.vstack([raw[chosen], refused]),
        warmth if program.thermometer is None else program.thermometer.value(warmth),
        np.vstack([model[chosen], nothing]),
        np.concatenate([status[chosen], stated]).astype(np.int64),
        float(off[chosen].max()),
    )


def _spread(sun: Floats) -> NDArray[np.int64]:
    """Places of directions (N, 3) far from each other: the farthest from those taken, in turns."""
    chosen = [int(np.argmin(np.linalg.norm(sun - sun.mean(axis=0), axis=1)))]
    nearest = np.full(len(sun), np.inf)
    while len(chosen) < min(_ROWS, len(sun)):
        nearest = np.minimum(nearest, np.linalg.norm(sun - sun[chosen[-1]], axis=1))
        chosen.append(int(nearest.argmax()))
    return np.array(chosen)


def _refused(program: Program, usual: Floats, kelvin: float) -> tuple[Floats, Floats]:
    """Rows that no program answers: no number, no light, too much, clipped, zeros, cold."""
    made = program.steps[0].constants
    place, dark, gain = made["place"], made["dark"], made["gain"]
    rows = [usual.copy(), np.zeros_like(usual)]
    rows[0][-1] = _NONE
    if made["least"] > -_NONE / 1e6:  # readings that add up to the light
        for light in (0.0, 1e3):
            row = usual.copy()
            row[place] = dark + light * gain * (usual[place] - dark) / gain
            rows.append(row)
    for limit in (made["low"], made["high"]):
        for at in np.flatnonzero(np.abs(limit) < made["largest"])[:1]:
            row = usual.copy()
            row[place[at]] = limit[at]
            rows.append(row)
    values, warm = np.vstack(rows), np.full(len(rows), kelvin)
    if program.thermometer is not None:
        values, warm = np.vstack([values, usual]), np.append(warm, kelvin + 500.0)
    return values, warm
