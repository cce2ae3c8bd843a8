"""A program as one Python module that needs NumPy alone: the same steps, copied from `runtime`."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from pathlib import Path
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
    return (
        (Path(__file__).parent / "module.txt")
        .read_text(encoding="utf-8")
        .format(
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
