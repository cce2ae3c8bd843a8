"""Test vectors: the calibration's own raw rows with the model's answers, and rows to refuse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import Floats
from calibrate.flight.program import Program, run

#: Rows with an answer.
_ROWS = 20
#: A reading that is none.
_NONE = 1e33


@dataclass(frozen=True)
class Vectors:
    """Raw readings in the file's order and what is expected of them.

    Attributes
    ----------
    values : ndarray, shape (V, K)
    temperature : ndarray, shape (V,)
        As the file has it.
    sun : ndarray, shape (V, 3)
        Of the model; NaN where the status is not 0.
    status : ndarray of int, shape (V,)
    largest_deg : float
        Largest difference of the program from the model on them.
    """

    values: Floats
    temperature: Floats
    sun: Floats
    status: NDArray[np.int64]
    largest_deg: float

    def __len__(self) -> int:
        return len(self.values)


def vectors_of(program: Program, raw: Floats, kelvin: Floats, model: Floats) -> Vectors:
    """Return rows spread over the field, then rows that must be refused.

    Parameters
    ----------
    program : Program
    raw : ndarray, shape (N, K)
        Of the calibration, in the file's order.
    kelvin : ndarray, shape (N,)
    model : ndarray, shape (N, 3)
        Answers of the fitted model; NaN where it has none.
    """
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
