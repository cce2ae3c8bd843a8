"""Flight code of a corrected calibration: its old program, other dark levels and gains, a turn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibrate.documents import SavedCalibration
from calibrate.flight.answers import Answers, answers_at
from calibrate.flight.code import FlightCode, judged_code
from calibrate.flight.program import NoCodeError, Program
from calibrate.flight.raw import RawLimits, raw_readings
from calibrate.flight.stored import program_of
from calibrate.readings import Readings
from calibrate.selection import deviation_of


def corrected_code(saved: SavedCalibration, poses: Readings) -> FlightCode:
    """Return the flight code of a corrected calibration.

    Parameters
    ----------
    saved : SavedCalibration
        With its correction.
    poses : Readings
        By its settings: those it was corrected by. Their raw rows compare code and calibration.

    Raises
    ------
    NoCodeError
        If the document holds no program, or the code departs from the corrected calibration by
        more than a tenth of its error.
    """
    program = _corrected(program_of(saved.document.get("flight")), saved)
    made = program.steps[0].constants
    raw = np.empty((len(poses), len(program.columns)))
    raw[:, made["place"]] = raw_readings(poses, saved.settings.readings)
    kelvin = poses.context.get("temperature_K", np.zeros(len(poses)))
    # steps answer in the old frame, which is turned last
    model = saved.predict(poses.features, poses.context) @ saved.rotation
    limits = RawLimits(made["low"], made["high"], made["least"], made["most"])
    found = judged_code(
        program, _answers(saved, poses), limits, raw, kelvin, model, saved.stated_deg
    )
    vectors = replace(found.vectors, sun=found.vectors.sun @ saved.rotation.T)
    return replace(found, vectors=vectors, judged_on="of the new poses")


def _corrected(program: Program, saved: SavedCalibration) -> Program:
    """Return the program with the dark levels and gains of a corrected calibration."""
    stated = saved.corrected.settings(saved.settings).readings
    count = len(stated.columns)
    if len(program.steps[0].constants["place"]) != count:
        raise NoCodeError("the old document's program is of other columns than its settings")
    sign = -1.0 if stated.inverted else 1.0
    constants = {
        **program.steps[0].constants,
        "dark": np.broadcast_to(np.asarray(stated.dark, dtype=np.float64), count).copy(),
        "gain": sign * np.broadcast_to(np.asarray(stated.gain, dtype=np.float64), count),
    }
    return replace(
        program, steps=(replace(program.steps[0], constants=constants), *program.steps[1:])
    )


def _answers(saved: SavedCalibration, poses: Readings) -> Answers:
    """Return the angles' form, the 1-sigma by place before the turn, and the turn."""
    sigma = np.nan
    if saved.intervals is None:
        stated = saved.factor * deviation_of(saved.model, poses.features, poses.context)
        sigma = float(np.sqrt(np.nanmean(stated**2)))
    found = answers_at(saved.settings.direction.form, saved.intervals, sigma)
    return replace(found, rotation=saved.rotation)
