"""95 % intervals on fresh poses, by band of 10 deg and axis, of models and of their C code."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from uneven import VECTOR, Uneven, ball, square

from calibrate.calibration import Calibration, calibrate
from calibrate.flight.code import flight_code
from calibrate.readings import readings_of
from calibrate.uncertainty import NORMAL_95, tangent_offsets

#: Poses of the calibration in a band of 10 deg for it to count, and poses judged afterwards.
FEWEST, FRESH = 100, 30_000
LEAST, MOST = 0.93, 0.97


@dataclass(frozen=True)
class Cell:
    """A band and axis: poses of the calibration there, and shares of fresh ones inside."""

    sensor: str
    seed: int
    band_deg: int
    axis: int
    poses: int
    model: float
    code: float

    @property
    def outside(self) -> bool:
        """Whether the model's intervals hold less than 93 % or more than 97 %."""
        return not LEAST <= self.model <= MOST


def even() -> dict[str, Uneven]:
    """Five sensors with the same noise everywhere, which models follow."""
    from faults import SENSORS as PLAIN

    return {
        kind: Uneven(
            tuple(one.names), ball if kind == "faces" else square(one.half_deg),
            lambda sun, drawn, read=one.read: read(sun, int(drawn.integers(1 << 30))), one.models,
        )
        for kind, one in PLAIN.items()
    }  # fmt: skip


def off_of(sun: np.ndarray) -> np.ndarray:
    return np.asarray(np.degrees(np.arccos(np.clip(sun[:, 2], -1.0, 1.0))) // 10.0).astype(int)


def cells(
    name: str, sensor: Uneven, seed: int, count: int, directory: Path, *, code: bool = False
) -> list[Cell]:
    """Calibrate by a file of so many poses, and judge the intervals on fresh ones."""
    drawn = np.random.default_rng([seed, count])
    table = sensor.table(count, drawn)
    columns = [table.columns[one] for one in (*sensor.names, *VECTOR)]
    path = directory / f"{name.replace(' ', '_')}.csv"
    header = ",".join((*sensor.names, *VECTOR))
    np.savetxt(path, np.column_stack(columns), delimiter=",", comments="", header=header)
    found = calibrate([path], sensor.settings, models=sensor.models)
    made = sensor.table(FRESH, drawn)
    fresh = readings_of(made, found.settings)
    predicted = found.model.predict(fresh.features, fresh.context)
    inside = held(predicted, found.deviations_deg(fresh.features), fresh.sun)
    coded = np.full(inside.shape, np.nan)
    if code:
        raw = np.column_stack([made.columns[one] for one in sensor.names])
        coded = held(*by_code(found, raw, directory), fresh.sun)
    assert np.isfinite(inside).all(axis=1).mean() > 0.9
    poses = np.bincount(off_of(np.column_stack(columns[-3:])), minlength=18)
    band = off_of(fresh.sun)
    return [
        Cell(
            name, seed, 10 * int(at), axis, int(poses[at]),
            *(_mean(one[band == at, axis]) for one in (inside, coded)),
        )
        for at in np.flatnonzero(poses >= FEWEST)
        for axis in (0, 1)
    ]  # fmt: skip


def held(answers: np.ndarray, sigma_deg: np.ndarray, sun: np.ndarray) -> np.ndarray:
    """1 of errors (N, 2) within their 95 % interval, 0 of others; NaN where not answered."""
    size = np.abs(tangent_offsets(answers - sun, sun))
    return np.where(np.isfinite(size), size <= NORMAL_95 * sigma_deg, np.nan)


def by_code(found: Calibration, raw: np.ndarray, directory: Path) -> tuple[np.ndarray, np.ndarray]:
    """Directions and 1-sigma by compiled C code; NaN where it refuses."""
    from raw_sensors import c_answers, written

    written(flight_code(found), directory)
    (directory / "example").unlink(missing_ok=True)
    answers = c_answers(directory, raw, ("-O2",))
    answers[answers[:, 0] != 0] = np.nan
    return answers[:, 1:4], answers[:, 6:8]


def _mean(inside: np.ndarray) -> float:
    known = inside[np.isfinite(inside)]
    return float(known.mean()) if len(known) else float("nan")
