"""A program in a calibration's document, so that a later correction can be written as code."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from calibrate.flight.program import (
    NoCodeError,
    Program,
    Step,
    Thermometer,
    step_functions,
)

_DAMAGED = (KeyError, TypeError, ValueError, AttributeError)


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
    """Return the program that a document holds.

    Raises
    ------
    NoCodeError
        If it holds none, or what is none.
    """
    if stored is None:
        raise NoCodeError(
            "the old document holds no program: no code was written with it, or it is older than "
            "programs in documents"
        )
    try:
        steps = tuple(
            Step(
                str(one["name"]),
                {name: _constant(value) for name, value in one["constants"].items()},
                int(one["operations"]),
                int(one["calls"]),
            )
            for one in stored["steps"]
        )
        measured = stored["thermometer"]
        thermometer = None if measured is None else Thermometer(**measured)
        made = Program(tuple(stored["columns"]), steps, thermometer, str(stored["words"]))
    except _DAMAGED as error:
        raise NoCodeError(f"the old document's program is damaged: {error}") from error
    unknown = [step.name for step in steps if step.name not in step_functions()]
    if unknown or not steps or steps[0].name != "readings":
        raise NoCodeError(f"the old document's program is damaged: steps {unknown or 'missing'}")
    return made


def _constant(value: Any) -> Any:
    return np.asarray(value) if isinstance(value, list) else value
