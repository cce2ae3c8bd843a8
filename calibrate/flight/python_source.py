"""A program as one Python module that needs NumPy alone: the same steps, copied from `runtime`."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from calibrate.flight.answers import Answers
from calibrate.flight.names import comment, comment_lines
from calibrate.flight.program import Program, Vectors, step_functions
from calibrate.flight.runtime import STATUSES


def python_module(
    program: Program, answers: Answers, vectors: Vectors, said: Mapping[str, str], digest: str
) -> str:
    """Return the text of a module with ``solve``, ``sun`` and ``selftest``.

    `said` is what comments at the top say, `digest` the SHA-256 of the calibration in hexadecimal
    digits.
    """
    steps = ",\n    ".join(f"({step.name}, {_mapping(step.constants)})" for step in program.steps)
    return _MODULE.format(
        said=comment_lines(said, "# "),
        digest=digest,
        statuses=STATUSES,
        columns=repr([comment(name) for name in program.columns]),
        warm=program.thermometer is not None,
        unit=program.thermometer.unit if program.thermometer else "not read",
        scale=program.thermometer.scale if program.thermometer else 1.0,
        offset=program.thermometer.offset if program.thermometer else 0.0,
        first=answers.form.python[0],
        second=answers.form.python[1],
        form=answers.form.words,
        functions="\n\n\n".join(_sources(program, answers)),
        steps=steps,
        sigma=_mapping(answers.constants()),
        rotation=f"ROTATION = {_array(answers.rotation)}\n" if answers.turns else "",
        turned=_TURNED if answers.turns else "",
        values=_array(vectors.values),
        temperature=_array(vectors.temperature),
        directions=_array(vectors.sun),
        expected=vectors.status.tolist(),
        most=1e-9 + 1.5 * vectors.largest_deg,
    )


def _sources(program: Program, answers: Answers) -> list[str]:
    """Return the source of the steps and of what they call, as they stand in the runtime."""
    texts = {name: inspect.getsource(one).rstrip() for name, one in step_functions().items()}
    wanted = [*(step.name for step in program.steps), "tangent_sigma"]
    wanted += ["turned"] if answers.turns else []
    for name in wanted:
        called = re.findall(r"\b(\w+)\(", texts[name])
        wanted += [other for other in called if other in texts and other not in wanted]
    return [text for name, text in texts.items() if name in wanted]


def _mapping(constants: Mapping[str, Any]) -> str:
    items = (
        f"{name!r}: {_array(value) if np.ndim(value) else repr(value)}"
        for name, value in constants.items()
    )
    return "{" + ", ".join(items) + "}"


def _array(values: Any) -> str:
    text = repr(np.asarray(values).tolist()).replace("nan", "np.nan")
    return f"np.array({text})"


_TURNED = "        found, sigma = turned(found, sigma, ROTATION)\n"
_MODULE = '''"""From raw readings of a Sun sensor to the Sun. Written by sunatlas calibrate."""

{said}
# Calibration SHA-256, first 32 digits: {digest}

from __future__ import annotations

import numpy as np

DIGEST = "{digest}"
STATUSES = {statuses}
COLUMNS = {columns}
NEEDS_TEMPERATURE = {warm}


{functions}


STEPS = [
    {steps},
]
SIGMA = {sigma}
{rotation}

def solve(readings, temperature=None):
    """Directions of raw readings, and what is known of them.

    Parameters
    ----------
    readings : array_like, shape (N, K)
        As the sensor gives them, in the order of COLUMNS.
    temperature : array_like, shape (N,), optional
        Where NEEDS_TEMPERATURE: {unit}, as the sensor gives it.

    Returns
    -------
    dict of str to ndarray
        ``sun`` (N, 3), unit vectors; ``angle_deg`` (N, 2), {form};
        ``sigma_deg`` (N, 2), one sigma along two axes square to the direction s, the first along
        s cross x (s cross y where |s_x| >= 0.9), the second s cross it;
        ``status`` (N,), places in STATUSES. Numbers are NaN unless the status is 0.
    """
    values = np.array(np.atleast_2d(readings), dtype=float)
    if values.shape[1] != len(COLUMNS):
        raise ValueError(f"expected readings of {{COLUMNS}}; got {{values.shape[1]}} a row")
    if NEEDS_TEMPERATURE and temperature is None:
        raise ValueError("expected a temperature of each row ({unit}); got none")
    given = 0.0 if temperature is None else temperature
    kelvin = {scale!r} * np.asarray(given, dtype=float) + {offset!r}
    kelvin = np.array(np.broadcast_to(kelvin, len(values)))
    found = np.full((len(values), 3), np.nan)
    status = np.zeros(len(values), dtype=int)
    with np.errstate(all="ignore"):
        for step, constants in STEPS:
            values, found, said = step(values, found, kelvin, constants)
            status = np.where(status == 0, said, status)
        found = np.where((status == 0)[:, None], found, np.nan)
        sigma = tangent_sigma(found, SIGMA)
{turned}        x, y, z = found.T
        angles_deg = np.degrees(np.column_stack([{first}, {second}]))
    sigma[status != 0] = np.nan
    return {{"sun": found, "angle_deg": angles_deg, "sigma_deg": sigma, "status": status}}


def sun(readings, temperature=None):
    """Unit vectors (N, 3) to the Sun of raw readings (N, K); NaN rows where there is no answer."""
    return solve(readings, temperature)["sun"]


def selftest():
    """Readings that differ from what the model says of them, and the largest difference, deg."""
    readings = {values}
    temperature = {temperature}
    model = {directions}
    expected = np.array({expected})
    made = solve(readings, temperature)
    off = np.degrees(np.linalg.norm(np.cross(made["sun"], model), axis=1))
    good = (made["status"] == expected) & ((expected != 0) | (off <= {most!r}))
    return int((~good).sum()), float(np.nanmax(off))


if __name__ == "__main__":
    wrong, largest = selftest()
    print(f"{{wrong}} readings differ from the model, largest difference {{largest:.2e}} deg")
    raise SystemExit(int(wrong > 0))
'''
