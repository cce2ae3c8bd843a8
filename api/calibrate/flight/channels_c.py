"""A table of channels as C99: float and fixed point, test vectors, a self-test, an example."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from algorithms.contract import Floats
from api.calibrate.flight.c_source import (
    c_array,
    c_float,
    c_said,
    c_template,
    filled,
    selftest,
)
from api.calibrate.flight.channels import ChannelTable, octant_of

#: Test vectors that are answered, and those that are not.
_VECTORS = 64
#: What signals are multiplied by for those.
_OFF = (0.0, 1e-3, 1e3, 1e4, 0.0, 1e-4, 1e5, 1e6)
#: The strongest signal that is answered, in parts of fixed point.
_PARTS = 2.0**26
#: Rough directions nearer than this to the border of an octant are no test vectors.
_BORDER = 1e-4


def channel_files(
    table: ChannelTable, signals: Floats, name: str, said: Mapping[str, str]
) -> dict[str, str]:
    """Return the text of each C file by its name, as `c_files` does for two features.

    Parameters
    ----------
    table : ChannelTable
    signals : ndarray, shape (N, n)
        Of the calibration; test vectors are taken of them.
    name : str
        A C identifier, the prefix of all names.
    said : mapping of str to str
        What the header's comment says.
    """
    count, terms = table.expected.shape[1], table.coefficients.shape[1]
    per_unit = float(np.float32(_PARTS / table.strongest))
    readings, sun = _vectors_of(table, signals)
    numbers = {
        "name": name,
        "NAME": name.upper(),
        "channels": str(count),
        "terms": str(terms),
        "squared": str(int(table.squared)),
        "operations": str(6 * count + 4 * terms),
        "flash": str(8 * (terms * 3 + count * 4) * 8 + count * 24 + 96 + 3072),
        "said": c_said(said),
        "weakest2": c_float(table.weakest**2), "strongest2": c_float(table.strongest**2),
        "weakest_q": str(round(table.weakest * per_unit)),
        "strongest_q": str(round(table.strongest * per_unit)),
        "vectors": str(len(readings)),
    }  # fmt: skip

    def fill(text: str) -> str:
        return filled(text, numbers)

    vectors = c_template("channels_vectors.h").replace("@DATA@", _vectors(readings, sun))
    source = c_template("channels.c").replace("@ROOT@", c_template("root.c"))
    data = f'/* Numbers of {name}.h. */\n#include "{name}.h"\n\n' + _data(table, per_unit) + "\n"
    return {
        f"{name}.h": fill(c_template("channels.h")),
        f"{name}.c": fill(source),
        f"{name}_table.c": fill(data),
        f"{name}_vectors.h": fill(vectors),
        f"{name}_selftest.c": fill(selftest("channels")),
        f"{name}_example.c": fill(c_template("channels_example.c")),
    }


def _vectors_of(table: ChannelTable, signals: Floats) -> tuple[Floats, Floats]:
    """Return signals (72, n), the last eight not to be answered, and their directions."""
    used = signals.astype(np.float32).astype(np.float64)
    length = np.linalg.norm(used, axis=1)
    unit = used / length[:, None]
    rough = unit @ table.first.T
    sun = table.predict(used)
    # none near a border, where the last digit of float decides
    clear = np.isfinite(sun).all(axis=1) & (np.abs(rough).min(axis=1) > _BORDER)
    clear &= (length > 1.01 * table.weakest) & (length < 0.99 * table.strongest)
    known = np.flatnonzero(clear)
    # every octant has its share
    places = known[np.argsort(octant_of(unit[known], table.first), kind="stable")]
    even = np.linspace(0, len(places) - 1, min(_VECTORS, len(places)))
    chosen = places[even.round().astype(np.int64)]
    off = used[chosen[:8]] * np.array(_OFF)[: len(chosen), None]
    readings = np.vstack([used[chosen], off]).astype(np.float32).astype(np.float64)
    return readings, table.predict(readings)


def _vectors(readings: Floats, sun: Floats) -> str:
    lines = []
    for signals, direction in zip(readings, sun, strict=True):
        valid = int(np.isfinite(direction).all())
        cosines = ", ".join(c_float(value) for value in (direction if valid else np.zeros(3)))
        given = ", ".join(c_float(value) for value in signals)
        lines.append(f"    {{ {{ {given} }}, {cosines}, {valid} }}")
    return ",\n".join(lines)


def _data(table: ChannelTable, per_unit: float) -> str:
    away2 = np.where(table.used, table.tolerance**2, -1.0)
    named = {
        "first": (table.first, 20, "[3U * %NAME%_CHANNELS]"),
        "terms": (table.coefficients, 24, "[8U * %NAME%_TERMS * 3U]"),
        "signals": (table.expected, 24, "[8U * %NAME%_CHANNELS * 4U]"),
    }
    parts = [f"const float %name%_per_unit = {c_float(per_unit)};"]
    for name, (values, places, size) in named.items():
        flat = values.reshape(-1)
        whole = np.round(flat * 2.0**places).astype(np.int64)
        parts += [
            c_array("const float", f"{name}_f", [c_float(v) for v in flat], size),
            c_array("const int32_t", f"{name}_q{places}", [str(int(v)) for v in whole], size),
        ]
    squares = np.round(away2 * 2.0**30).astype(np.int64)
    parts += [
        c_array("const float", "away2_f", [c_float(v) for v in away2], "[8]"),
        c_array("const int64_t", "away2_q30", [f"INT64_C({v})" for v in squares], "[8]"),
    ]
    return "\n\n".join(parts)
