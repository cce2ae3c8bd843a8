"""A program as C99 that a C++ compiler takes too, and as one Python module that needs NumPy alone.

The C code allocates nothing, has no variable that outlives a call and no loop without a bound. Both
have the same steps as `runtime`.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from calibrate.flight.answers import Answers
from calibrate.flight.names import comment, comment_lines
from calibrate.flight.program import Program, Step, Thermometer, Vectors, step_functions
from calibrate.flight.runtime import STATUSES

_TEMPLATES = Path(__file__).parent / "c"
_PARTS = ("readings.c", "plane.c", "faces.c", "assembled.c")
_PER_LINE = 4
#: Difference from the model that the self-test allows beside the one that was measured, degrees.
_ROUNDING, _ROUNDING_FLOAT = 1e-9, 0.02


@dataclass(frozen=True)
class _Part:
    """A function of the templates: a step or what steps call."""

    kind: str
    text: str


def c_files(  # noqa: PLR0917 - what the files are made of
    program: Program,
    answers: Answers,
    vectors: Vectors,
    name: str,
    said: Mapping[str, str],
    digest: str,
) -> dict[str, str]:
    """Return the text of each C file by its name: header, source, self-test and example.

    `name` is an identifier, the prefix of all names; `said` what the header's comment says;
    `digest` the SHA-256 of the calibration in hexadecimal digits.
    """
    readings = len(program.columns)
    inputs = list(program.columns)
    temperature, kelvin = "not read", "R(0.0)"
    if program.thermometer is not None:
        inputs.append(program.thermometer.column)
        temperature = comment(f"{program.thermometer.unit}, column {program.thermometer.column}")
        kelvin = _kelvin(program.thermometer)
    first, second = answers.form.c
    texts = {
        "name": name,
        "NAME": name.upper(),
        "digest": digest,
        "run": digest[:16],
        "said": comment_lines(said, " * "),
        "raw": str(readings),
        "width": str(max(readings, 3)),
        "temperature": temperature,
        "kelvin": kelvin,
        "angles": answers.form.words,
        "first_angle": first,
        "second_angle": second,
        "functions": _functions(program, name),
        "calls": "\n".join(_call(at, step) for at, step in enumerate(program.steps, 1)),
        "sigma": _constants(answers.places()),
        **_answers(answers),
        "vectors": str(len(vectors)),
        "vector_data": _vectors(vectors, name),
        "most": repr(_ROUNDING + 1.5 * vectors.largest_deg),
        "most_float": repr(_ROUNDING_FLOAT + 1.5 * vectors.largest_deg),
        "columns": str(len(inputs)),
        "columns_said": comment(", ".join(inputs)),
    }

    def fill(template: str) -> str:
        return filled((_TEMPLATES / template).read_text(encoding="utf-8"), texts)

    return {
        f"{name}.h": fill("header.h"),
        f"{name}.c": _used(_numbered(fill("source.c"), answers.places())),
        f"{name}_selftest.c": fill("selftest.c"),
        f"{name}_example.c": fill("example.c"),
    }


def _answers(answers: Answers) -> dict[str, str]:
    """Return what widens one sigma at grazing light and turns answers, and the calls of it."""
    text = (_TEMPLATES / "answers.c").read_text(encoding="utf-8")
    pieces = re.split(r"/\* part: (\w+) \*/\n", text)
    parts = dict(zip(pieces[1::2], pieces[2::2], strict=True))
    made, calls = "", {"grown": "", "turned": ""}
    if answers.grazes:
        calls["grown"] = "    grazing(sun, sigma);\n"
        faces = answers.faces()
        made += _numbered(parts["grazing"], faces).replace("%constants%", _constants(faces))
    if answers.turns:
        calls["turned"] = "        turned(sun, out->sigma_deg);\n"
        rotation = {"rotation": answers.rotation}
        made += parts["turned"].replace("%constants%", _constants(rotation))
    return {"answers": parts["across"] + made if made else "", **calls}


def filled(text: str, texts: Mapping[str, str]) -> str:
    """Return a template with each ``%key%`` replaced, twice: texts hold keys, too."""
    for _ in range(2):
        text = re.sub(r"%(\w+)%", lambda found: texts.get(found[1], found[0]), text)
    return text


@cache
def _parts() -> dict[str, _Part]:
    """Return every function of the templates by its name, in the order they have to stand."""
    found = {}
    for file in _PARTS:
        text = (_TEMPLATES / file).read_text(encoding="utf-8")
        pieces = re.split(r"/\* (step|helper): (\w+) \*/\n", text)
        for kind, name, body in zip(pieces[1::3], pieces[2::3], pieces[3::3], strict=True):
            found[name] = _Part(kind, body)
    return found


def _functions(program: Program, name: str) -> str:
    """Return what the steps call, and the steps, as functions."""
    bodies = {f"step_{at}_{step.name}": step for at, step in enumerate(program.steps, 1)}
    texts = [_function(function, step) for function, step in bodies.items()]
    called: dict[str, str] = {}
    waiting = list(texts)
    while waiting:
        text = waiting.pop()
        for helper, part in _parts().items():
            if part.kind == "helper" and helper not in called and f"{helper}(" in text:
                called[helper] = part.text
                waiting.append(part.text)
    helpers = [called[helper] for helper in _parts() if helper in called]
    return "\n".join([*helpers, *texts]).replace("%name%", name)


def _function(function: str, step: Step) -> str:
    body = _numbered(_parts()[step.name].text, step.constants)
    unread = [name for name in ("v", "sun", "kelvin") if not re.search(rf"\b{name}\b", body)]
    head = (
        f"static %name%_status {function}(real v[WIDTH], real sun[3], real kelvin)\n{{\n"
        f"{_constants(step.constants)}    %name%_status status = %NAME%_OK;\n"
    )
    end = "".join(f"    (void){name};\n" for name in unread)
    return f"{head}{body}{end}    return status;\n}}\n"


def _numbered(text: str, constants: Mapping[str, Any]) -> str:
    """Return a template with integers in place of their names in capitals."""
    for name, value in constants.items():
        if isinstance(value, int):
            text = re.sub(rf"\b{name.upper()}\b", str(value), text)
    return re.sub(r"\[(\d+) \+ 1\]", lambda size: f"[{int(size[1]) + 1}]", text)


def _used(text: str) -> str:
    """Return a source without macros that it does not use."""
    for name in re.findall(r"#define (\w+)", text):
        if len(re.findall(rf"\b{name}\b", text)) == len(re.findall(rf"#define {name}\b", text)):
            text = re.sub(rf"#define {name}\b.*\n", "", text)
    return text


def _kelvin(thermometer: Thermometer) -> str:
    """Return the expression that makes a temperature kelvin."""
    scale, offset = c_real(thermometer.scale), c_real(thermometer.offset)
    scaled = "in->temperature" if thermometer.scale == 1.0 else f"({scale} * in->temperature)"
    return scaled if thermometer.offset == 0.0 else f"{scaled} + {offset}"


def _call(at: int, step: Step) -> str:
    call = f"status = step_{at}_{step.name}(v, sun, kelvin);"
    if at == 1:
        return f"    {call}"
    return f"    if (status == %NAME%_OK)\n    {{\n        {call}\n    }}"


def _constants(constants: Mapping[str, Any]) -> str:
    """Return the definitions of constants in a function; integers stand in its text."""
    lines = []
    for name, value in constants.items():
        if np.ndim(value):
            whole = np.issubdtype(np.asarray(value).dtype, np.integer)
            flat = np.asarray(value).reshape(-1).tolist()
            numbers = [str(one) if whole else c_real(one) for one in flat]
            kind = "int" if whole else "real"
            rows = [
                "        " + ", ".join(numbers[at : at + _PER_LINE])
                for at in range(0, len(numbers), _PER_LINE)
            ]
            lines.append(f"    static const {kind} {name}[{len(flat)}] =\n    {{")
            lines.append(",\n".join(rows) + "\n    };")
        elif isinstance(value, float):
            lines.append(f"    const real {name} = {c_real(value)};")
    return "".join(f"{line}\n" for line in lines)


def _vectors(vectors: Vectors, name: str) -> str:
    lines = []
    for values, warmth, sun, status in zip(
        vectors.values, vectors.temperature, vectors.sun, vectors.status, strict=True
    ):
        reading = ", ".join(c_real(one) for one in values)
        direction = ", ".join(c_real(one) for one in np.nan_to_num(sun))
        said = f"{name.upper()}_{STATUSES[status]}"
        lines.append(
            f"    {{ {{ {{ {reading} }}, {c_real(warmth)} }}, {{ {direction} }}, {said} }}"
        )
    return ",\n".join(lines)


def c_real(value: float) -> str:
    """Return a number as C has it, in the precision of the computation."""
    text = repr(float(value))
    return f"R({text})" if any(c in text for c in ".e") else f"R({text}.0)"


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
