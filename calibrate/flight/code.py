"""Flight code of a calibration: what it does, what it adds to the model, and its files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from algorithms.angles import separation_deg
from algorithms.contract import FeatureKind, Floats
from calibrate.calibration import Calibration
from calibrate.documents import SavedCalibration
from calibrate.flight.answers import Answers, answers_at, answers_of
from calibrate.flight.faces import faces_steps
from calibrate.flight.plane import plane_steps
from calibrate.flight.program import (
    NoCodeError,
    Program,
    Step,
    Thermometer,
    Vectors,
    program_of,
    run,
    vectors_of,
)
from calibrate.flight.runtime import STATUSES
from calibrate.flight.sources import c_files, python_module
from calibrate.forms.units import KELVIN
from calibrate.readings import MATRICES, Readings, raw_of
from calibrate.selection import deviation_of
from calibrate.settings import ReadingsSettings, RowSettings, Settings

#: Share of the model's error above which what the code adds is refused.
_MOST_ADDED = 0.1
#: Of temperatures in other units.
_ROUNDING_K = 1e-9
#: Rows of the calibration by which code is judged.
_JUDGED = 2000
_KINDS = ("spot", "balance", "quadrants", "electrodes", "channels")


@dataclass(frozen=True)
class FlightCode:
    """Flight code of a calibration.

    The difference from the model, RMS and largest, is that on the calibration's own raw rows.
    """

    program: Program
    answers: Answers
    vectors: Vectors  # of the self-test
    limits: RawLimits
    added_deg: float
    largest_deg: float
    flagged: Mapping[str, int]  # rows that only the model answers, by status
    rows: int  # that were compared
    judged_on: str = "rows of the calibration"  # what these rows are of

    @property
    def words(self) -> str:
        """Name what the code computes instead of the model, for a report."""
        return self.program.words

    @property
    def sentence(self) -> str:
        """Say what the code adds to the model, and which rows it refuses."""
        refused = ", ".join(f"{count} {name}" for name, count in self.flagged.items())
        return (
            f"{self.words}: adds {self.added_deg:.2g} deg RMS to the model, at most "
            f"{self.largest_deg:.2g} deg, on {self.rows} {self.judged_on}"
            + (f"; {sum(self.flagged.values())} of them refused ({refused})" if refused else "")
        )

    def files(self, name: str, said: Mapping[str, str], digest: str) -> dict[str, str]:
        """Return the text of each file of C and of Python by its name.

        `name` is an identifier, as `calibrate.flight.names.c_name` makes it, `said` what comments
        at the top say first, `digest` the SHA-256 of the calibration in hexadecimal digits.
        """
        told = {**said, **self._told()}
        return {
            f"{name}.py": python_module(self.program, self.answers, self.vectors, told, digest),
            **c_files(self.program, self.answers, self.vectors, name, told, digest),
        }

    def _told(self) -> dict[str, str]:
        """Return what comments say of inputs, steps, limits, accuracy and cost."""
        program, limits = self.program, self.limits
        made = program.steps[0].constants
        lines = {"Code": self.sentence, "Steps": ", ".join(s.name for s in program.steps)}
        for at, name in enumerate(program.columns):
            place = int(np.flatnonzero(made["place"] == at)[0])
            lines[f"Input value[{at}]"] = (
                f"column {name}, in its unit; dark {made['dark'][place]:.6g}, gain "
                f"{made['gain'][place]:.6g}{_clipped(limits, place)}"
            )
        if program.thermometer is not None:
            lines["Input temperature"] = (
                f"column {program.thermometer.column}, {program.thermometer.unit}"
            )
        if limits.least_light > -LARGEST:
            lines["Light"] = (
                f"readings less dark over gain add up to {limits.least_light:.6g} to "
                f"{limits.most_light:.6g}"
            )
        lines["Frame"] = "+z is the boresight; the answer is the unit vector from sensor to Sun"
        size = program.bytes + self.answers.bytes
        operations = program.operations + self.answers.operations
        calls = program.calls + self.answers.calls
        lines["Cost"] = (
            f"at most {operations} additions, multiplications, divisions and comparisons "
            f"and {calls} calls of libm an answer; {size} bytes of constants in double "
            "precision; no heap, nothing kept between calls"
        )
        return lines


def flight_code(found: Calibration) -> FlightCode:
    """Return the flight code of a calibration.

    NoCodeError if no code is written for its model, or the code departs from the model by more than
    a tenth of the model's error.
    """
    settings, readings = found.settings, found.readings
    kind = settings.readings.kind
    if kind not in _KINDS:
        raise NoCodeError(f"flight code takes readings of {', '.join(_KINDS)}; these are {kind}")
    if readings.features.shape[1] == 2 and not np.ptp(readings.features, axis=0).all():
        raise NoCodeError("flight code is not written for sensors of one axis")
    context = tuple(found.model.about.context)
    if set(context) - {"temperature_K"}:
        raise NoCodeError(f"code for flight knows no {', '.join(context)}")
    columns = columns_of(found)
    allowed = limits_of(found)
    steps = raw_steps(columns, settings, allowed)
    thermometer = _thermometer(settings.rows) if context else None
    if thermometer is not None:
        steps.append(_temperatures(readings.context["temperature_K"]))
    used = readings.thinned(_JUDGED)
    if readings.kind is FeatureKind.SIGNALS:
        made, words = faces_steps(found.model, used.features, used.context)
    else:
        made, words = plane_steps(
            found.model, readings.features, readings.context, found.chosen.rms_deg
        )
    program = Program(columns, (*steps, *made), thermometer, words)
    raw = np.empty((len(used), len(columns)))
    raw[:, steps[0].constants["place"]] = raw_of(used.raw, settings.readings)
    kelvin = used.context.get("temperature_K", np.zeros(len(used)))
    model = found.model.predict(used.features, used.context)
    return judged_code(
        program, answers_of(found), allowed, raw, kelvin, model, found.chosen.rms_deg
    )


def judged_code(  # noqa: PLR0917 - what code is made of
    program: Program,
    answers: Answers,
    limits: RawLimits,
    raw: Floats,
    kelvin: Floats,
    model: Floats,
    rms_deg: float,
) -> FlightCode:
    """Return code by a program whose answers are those of a model on raw rows.

    Rows (N, K) stand in the file's order; `model` (N, 3) is before the turn of the answers and NaN
    where there is none. NoCodeError if the program answers none of the rows or adds more than a
    tenth of the model's error.
    """
    _, sun, status = run(program.steps, raw, kelvin)
    off = separation_deg(sun, model)
    both = np.isfinite(off)
    if not both.any():
        raise NoCodeError("the code answers none of the calibration's rows that the model answers")
    added = float(np.sqrt(np.mean(off[both] ** 2)))
    if not added <= _MOST_ADDED * rms_deg:
        raise NoCodeError(
            f"{program.words} would add {added:.3g} deg to a model that errs "
            f"{rms_deg:.3g} deg, more than a tenth of it"
        )
    lost = status[np.isfinite(model[:, 0]) & (status != 0)]
    counts = {STATUSES[one]: int((lost == one).sum()) for one in np.unique(lost)}
    return FlightCode(
        program, answers, vectors_of(program, raw, kelvin, model), limits, added,
        float(off[both].max()), counts, len(raw),
    )  # fmt: skip


def _temperatures(kelvin: Floats) -> Step:
    low, high = float(kelvin.min()) - _ROUNDING_K, float(kelvin.max()) + _ROUNDING_K
    return Step("temperature_range", {"low": low, "high": high}, 2)


def _thermometer(rows: RowSettings) -> Thermometer:
    unit = rows.temperature_unit
    return Thermometer(rows.temperature_K or "temperature_K", unit, *KELVIN[unit])


def _clipped(limits: RawLimits, place: int) -> str:
    low, high = float(limits.low[place]), float(limits.high[place])
    said = f", clipped at {low:.6g} and below" if low > -LARGEST else ""
    return said + (f", clipped at {high:.6g} and above" if high < LARGEST else "")


def corrected_code(saved: SavedCalibration, poses: Readings) -> FlightCode:
    """Return the flight code of a corrected calibration.

    Raw rows of the poses that it was corrected by compare code and calibration. NoCodeError if the
    document holds no program or one that cannot run, or the code departs by more than a tenth of
    the error.
    """
    try:
        return _corrected_code(saved, poses)
    except NoCodeError:
        raise
    except (LookupError, TypeError, ValueError, StopIteration) as error:  # of constants that misfit
        raise NoCodeError(f"the old document's program is damaged: {error!s:.200}") from error


def _corrected_code(saved: SavedCalibration, poses: Readings) -> FlightCode:
    program = _corrected(program_of(saved.document.get("flight")), saved)
    made = program.steps[0].constants
    raw = np.empty((len(poses), len(program.columns)))
    raw[:, made["place"]] = raw_of(poses.raw, saved.settings.readings)
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
    first = program.steps[0].constants
    if len(first["place"]) != count:
        raise NoCodeError("the old document's program is of other columns than its settings")
    if any(np.shape(first[name]) != (count,) for name in ("low", "high")):
        raise NoCodeError("the old document's program is damaged: limits of other columns")
    constants = {
        **first,
        "dark": np.broadcast_to(np.asarray(stated.dark, dtype=np.float64), count).copy(),
        "gain": stated.sign * np.broadcast_to(np.asarray(stated.gain, dtype=np.float64), count),
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


#: Beyond this a reading is no number; of limits, that there is none.
LARGEST = 1e30
#: Of a limit, how far a reading may be rounded in the file and not on board.
_ROUNDING = 1e-6


@dataclass(frozen=True)
class RawLimits:
    """What readings may be, by column of the settings, and their sum less dark over gain."""

    low: Floats
    high: Floats
    least_light: float
    most_light: float


def limits_of(found: Calibration) -> RawLimits:
    """Return the limits that a calibration found, as finite numbers that C can hold."""
    count, known = len(found.settings.readings.columns), found.limits
    of_light = np.isfinite(known.most_light)
    low = np.maximum(np.array(known.low or (-np.inf,) * count), -LARGEST)
    high = np.minimum(np.array(known.high or (np.inf,) * count), LARGEST)
    return RawLimits(
        np.where(low > -LARGEST, low + _ROUNDING * np.abs(low), low),
        np.where(high < LARGEST, high - _ROUNDING * np.abs(high), high),
        float(known.least_light) if of_light else -LARGEST,
        float(known.most_light) if of_light else LARGEST,
    )


def columns_of(found: Calibration) -> tuple[str, ...]:
    """Return the columns of readings in the file's order."""
    known = set(found.settings.readings.columns)
    inside = tuple(name for name in found.columns if name in known)
    return inside if len(inside) == len(known) else found.settings.readings.columns


def places_of(columns: Sequence[str], settings: ReadingsSettings) -> NDArray[np.int64]:
    """Return the place (K,) in the file's order of each column of the settings."""
    return np.array([list(columns).index(name) for name in settings.columns])


def raw_steps(columns: Sequence[str], settings: Settings, limits: RawLimits) -> list[Step]:
    """Return the steps from raw readings to features."""
    stated = settings.readings
    count = len(stated.columns)
    steps = [
        Step(
            "readings",
            {
                "readings": count,
                "place": places_of(columns, stated),
                "dark": np.broadcast_to(np.asarray(stated.dark, dtype=np.float64), count).copy(),
                "gain": stated.sign
                * np.broadcast_to(np.asarray(stated.gain, dtype=np.float64), count).copy(),
                "low": np.asarray(limits.low, dtype=np.float64),
                "high": np.asarray(limits.high, dtype=np.float64),
                "largest": LARGEST,
                "least": float(limits.least_light),
                "most": float(limits.most_light),
            },
            9 * count + 2,
        )
    ]
    if stated.kind == "quadrants":
        steps.append(Step("quadrants", {}, 12))
    if stated.kind == "electrodes":
        steps.append(Step("electrodes", {}, 8))
    matrix = np.eye(2)
    for transform in settings.apply:
        matrix = np.asarray(MATRICES[transform]) @ matrix
    if stated.kind != "channels" and not np.array_equal(matrix, np.eye(2)):
        steps.append(Step("axes", {"matrix": matrix}, 6))
    return steps
