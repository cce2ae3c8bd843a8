"""A flight table as C99: float and fixed point, hull check, test vectors, a self-test, an example.

The code allocates nothing, calls nothing of the mathematics library but ``sqrtf`` (fixed point:
nothing), has no global that changes, and answers a flag outside the hull.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from algorithms.contract import Floats
from api.calibrate.flight.table import FlightTable

#: Test vectors inside the hull; eight outside follow them.
_VECTORS = 64
_PER_LINE = 4
_TEMPLATES = Path(__file__).parent / "c"


def c_name(text: str) -> str:
    """Return a C identifier made of a name."""
    word = re.sub(r"[^a-z0-9]+", "_", text.lower()).strip("_") or "sensor"
    return word if word[0].isalpha() else f"sensor_{word}"


def c_files(table: FlightTable, name: str, said: Mapping[str, str]) -> dict[str, str]:
    """Return the text of each C file by its name.

    Parameters
    ----------
    table : FlightTable
    name : str
        A C identifier, the prefix of all names.
    said : mapping of str to str
        What the header's comment says: sensor, model, digest, versions, command.

    Returns
    -------
    dict of str to str
        ``NAME.h``, ``NAME.c``, ``NAME_vectors.h``, ``NAME_selftest.c``, ``NAME_example.c``,
        ``NAME_table.c`` (the numbers alone, as a cFS table image's source).
    """
    rows, columns = table.nodes.shape[:2]
    numbers = {
        "name": name,
        "NAME": name.upper(),
        "rows": str(rows),
        "columns": str(columns),
        "sides": str(len(table.sides)),
        "flash": str(rows * columns * 2 * 8 + len(table.sides) * 3 * 12 + 2048),
        "said": c_said(said),
        "low_x": c_float(table.low[0]), "low_y": c_float(table.low[1]),
        "per_x": c_float(1.0 / table.step[0]), "per_y": c_float(1.0 / table.step[1]),
        "last_x": f"{columns - 1}.0F", "last_y": f"{rows - 1}.0F",
        "vectors": str(_VECTORS + 8),
    }  # fmt: skip

    def fill(text: str) -> str:
        return filled(text, numbers)

    return {
        f"{name}.h": fill(c_template("sensor.h")),
        f"{name}.c": fill(c_template("sensor.c").replace("@ROOT@", c_template("root.c"))),
        f"{name}_table.c": fill(c_template("table.c").replace("@DATA@", _data(table))),
        f"{name}_vectors.h": fill(c_template("vectors.h").replace("@DATA@", _vectors(table))),
        f"{name}_selftest.c": fill(selftest("spot")),
        f"{name}_example.c": fill(c_template("example.c")),
    }


def vectors_of(table: FlightTable) -> tuple[Floats, Floats]:
    """Return features (72, 2) inside and outside the hull, and the directions (72, 3) they give."""
    rows, columns = table.nodes.shape[:2]
    low = np.asarray(table.low) + np.asarray(table.step)
    high = low + np.asarray(table.step) * (np.array([columns, rows]) - 3)
    turns = np.arange(1, 4001)
    places = low + (high - low) * np.column_stack(
        [(turns * 0.754877666) % 1, (turns * 0.569840296) % 1]
    )
    inside = (places @ table.sides[:, :2].T + table.sides[:, 2]).max(axis=1) < -1e-3 * float(
        np.min(table.step)
    )
    chosen = places[inside][:_VECTORS]
    around = np.array(
        [[-1, -1], [2, 2], [-1, 0.5], [0.5, -1], [2, 0.5], [0.5, 2], [-1, 2], [2, -1]]
    )
    chosen = np.vstack([chosen, low + (high - low) * around])
    chosen = chosen.astype(np.float32).astype(np.float64)
    return chosen, table.predict(chosen)


def _vectors(table: FlightTable) -> str:
    features, sun = vectors_of(table)
    lines = []
    for place, direction in zip(features, sun, strict=True):
        valid = int(np.isfinite(direction).all())
        cosines = direction if valid else np.zeros(3)
        numbers = ", ".join(c_float(value) for value in (*place, *cosines))
        lines.append(f"    {{ {numbers}, {valid} }}")
    return ",\n".join(lines)


def _data(table: FlightTable) -> str:
    flat = table.nodes.reshape(-1)
    scaled = np.round(flat * 2.0**30).astype(np.int64).clip(-(2**31) + 1, 2**31 - 1)
    low, step = np.asarray(table.low), np.asarray(table.step)
    # in cells from the first node, so that fixed point needs no other scale: a x' + b y' + c' <= 0
    sides = np.column_stack(
        [table.sides[:, :2] * step, table.sides[:, 2] + table.sides[:, :2] @ low]
    )
    sides /= np.linalg.norm(sides[:, :2], axis=1)[:, None]
    fixed = np.column_stack(
        [np.round(sides[:, :2] * 2.0**16), np.round(sides[:, 2] * 2.0**16)]
    ).astype(np.int64)
    nodes, numbers = "[%NAME%_NODES]", "[%NAME%_SIDE_NUMBERS]"
    return "\n\n".join(
        [
            c_array("const float", "nodes_f", [c_float(v) for v in flat], nodes),
            c_array("const int32_t", "nodes_q30", [str(int(v)) for v in scaled], nodes),
            c_array("const float", "sides_f", [c_float(v) for v in sides.flat], numbers),
            c_array("const int32_t", "sides_q16", [f"{v:d}" for v in fixed.flat], numbers),
        ]
    )  # fmt: skip


def c_said(said: Mapping[str, str]) -> str:
    """Return lines of a comment that name what a header is of."""
    return "\n".join(f" * {key}: {c_comment(value)}" for key, value in said.items())


def selftest(what: str) -> str:
    """Return the template of a self-test of spots or of channels."""
    fixed, asked = c_template(f"selftest_{what}.c").split("@@\n")
    text = c_template("selftest.c").replace("@FIXED@\n", fixed + "\n")
    return text.replace("@ASKED@\n", asked)


def c_array(kind: str, name: str, values: list[str], size: str) -> str:
    """Return the definition of an array."""
    lines = [
        "    " + ", ".join(values[at : at + _PER_LINE]) for at in range(0, len(values), _PER_LINE)
    ]
    return f"{kind} %name%_{name}{size} =\n{{\n" + ",\n".join(lines) + "\n};"


def c_float(value: float) -> str:
    """Return a number as C has it, of type float."""
    text = f"{np.float32(value):.9g}"
    return f"{text}F" if any(c in text for c in ".e") else f"{text}.0F"


def c_comment(text: str) -> str:
    """Return text that ends no comment."""
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\n", " ")


def c_template(name: str) -> str:
    """Return a template's text."""
    return (_TEMPLATES / name).read_text(encoding="utf-8")


def filled(text: str, numbers: Mapping[str, str]) -> str:
    """Return a template with each ``%key%`` replaced."""
    for key, value in numbers.items():
        text = text.replace(f"%{key}%", value)
    return text
