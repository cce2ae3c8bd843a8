"""A flight table as C99: float and fixed point, hull check, test vectors, a self-test, an example.

The code allocates nothing, calls nothing of the mathematics library but ``sqrtf`` (fixed point:
nothing), has no global that changes, and answers a flag outside the hull.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from algorithms.contract import Floats
from api.calibrate.flight_table import FlightTable

#: Test vectors inside the hull; eight outside follow them.
_VECTORS = 64
_PER_LINE = 4


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
        "said": "\n".join(f" * {key}: {_comment(value)}" for key, value in said.items()),
        "low_x": _float(table.low[0]), "low_y": _float(table.low[1]),
        "per_x": _float(1.0 / table.step[0]), "per_y": _float(1.0 / table.step[1]),
        "last_x": f"{columns - 1}.0F", "last_y": f"{rows - 1}.0F",
        "vectors": str(_VECTORS + 8),
    }  # fmt: skip

    def fill(text: str) -> str:
        return _filled(text, numbers)

    return {
        f"{name}.h": fill(_HEADER),
        f"{name}.c": fill(_SOURCE),
        f"{name}_table.c": fill(_TABLE.replace("@DATA@", _data(table))),
        f"{name}_vectors.h": fill(_VECTORS_H.replace("@DATA@", _vectors(table))),
        f"{name}_selftest.c": fill(_SELFTEST),
        f"{name}_example.c": fill(_EXAMPLE),
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
        numbers = ", ".join(_float(value) for value in (*place, *cosines))
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
    return "\n\n".join(
        [
            _array("const float", "nodes_f", [_float(v) for v in flat], "_NODES"),
            _array("const int32_t", "nodes_q30", [str(int(v)) for v in scaled], "_NODES"),
            _array("const float", "sides_f", [_float(v) for v in sides.flat], "_SIDE_NUMBERS"),
            _array("const int32_t", "sides_q16", [f"{v:d}" for v in fixed.flat], "_SIDE_NUMBERS"),
        ]
    )  # fmt: skip


def _array(kind: str, name: str, values: list[str], size: str) -> str:
    lines = [
        "    " + ", ".join(values[at : at + _PER_LINE]) for at in range(0, len(values), _PER_LINE)
    ]
    return f"{kind} %name%_{name}[%NAME%{size}] =\n{{\n" + ",\n".join(lines) + "\n};"


def _float(value: float) -> str:
    text = f"{np.float32(value):.9g}"
    return f"{text}F" if any(c in text for c in ".e") else f"{text}.0F"


def _comment(text: str) -> str:
    return text.replace("*/", "* /").replace("/*", "/ *").replace("\n", " ")


def _filled(text: str, numbers: Mapping[str, str]) -> str:
    for key, value in numbers.items():
        text = text.replace(f"%{key}%", value)
    return text


_HEADER = """/*
 * Sun direction of a calibrated Sun sensor. Written by sunatlas calibrate.
%said%
 *
 * Frame: +z is the boresight; the result is the unit vector from the sensor to the Sun.
 * Flash: about %flash% bytes of constants and code. Stack: below 160 bytes. No memory is
 * allocated and nothing is kept between calls. Operations: 42 multiplications, %sides% hull sides
 * of two each, and one square root, whatever the reading.
 */
#ifndef %NAME%_H
#define %NAME%_H

#include <stdint.h>

#define %NAME%_ROWS         (%rows%U)
#define %NAME%_COLUMNS      (%columns%U)
#define %NAME%_SIDES        (%sides%U)
#define %NAME%_NODES        (%NAME%_ROWS * %NAME%_COLUMNS * 2U)
#define %NAME%_SIDE_NUMBERS (%NAME%_SIDES * 3U)

/* First node, and nodes per unit of each feature. */
#define %NAME%_LOW_X (%low_x%)
#define %NAME%_LOW_Y (%low_y%)
#define %NAME%_PER_X (%per_x%)
#define %NAME%_PER_Y (%per_y%)
/* The last node. */
#define %NAME%_LAST_X (%last_x%)
#define %NAME%_LAST_Y (%last_y%)

typedef enum
{
    %NAME%_OK = 0,          /* a direction was found */
    %NAME%_OUTSIDE = 1      /* the reading lies outside what was calibrated, or is no number */
} %name%_status_t;

extern const float %name%_nodes_f[%NAME%_NODES];
extern const int32_t %name%_nodes_q30[%NAME%_NODES];
extern const float %name%_sides_f[%NAME%_SIDE_NUMBERS];
extern const int32_t %name%_sides_q16[%NAME%_SIDE_NUMBERS];

/* Direction cosines of a reading (x, y) in the calibration's units; sun is zero unless OK. */
%name%_status_t %name%_sun(float x, float y, float sun[3]);

/* The same in fixed point: x and y in nodes from the first one, Q16; sun in Q30.
 * cells = (reading - LOW) * PER; range -32768 to 32767 nodes. */
%name%_status_t %name%_sun_q(int32_t x_q16, int32_t y_q16, int32_t sun_q30[3]);

#endif /* %NAME%_H */
"""

_SOURCE = """/* See %name%.h. */
#include "%name%.h"

#include <math.h>

static uint32_t corner_of(int32_t whole, uint32_t count)
{
    uint32_t corner;

    if (whole < 1)
    {
        corner = 1U;
    }
    else if ((uint32_t)whole > (count - 3U))
    {
        corner = count - 3U;
    }
    else
    {
        corner = (uint32_t)whole;
    }
    return corner;
}

static void weights_f(float t, float w[4])
{
    w[0] = ((((-0.5F * t) + 1.0F) * t) - 0.5F) * t;
    w[1] = (((1.5F * t) - 2.5F) * t * t) + 1.0F;
    w[2] = ((((-1.5F * t) + 2.0F) * t) + 0.5F) * t;
    w[3] = ((0.5F * t) - 0.5F) * t * t;
}

%name%_status_t %name%_sun(float x, float y, float sun[3])
{
    %name%_status_t status = %NAME%_OK;
    const float px = (x - %NAME%_LOW_X) * %NAME%_PER_X;
    const float py = (y - %NAME%_LOW_Y) * %NAME%_PER_Y;
    uint32_t side;

    sun[0] = 0.0F;
    sun[1] = 0.0F;
    sun[2] = 0.0F;
    /* no number fails both comparisons, and readings far outside are no array index */
    if (!((px >= 0.0F) && (px <= %NAME%_LAST_X) &&
          (py >= 0.0F) && (py <= %NAME%_LAST_Y)))
    {
        status = %NAME%_OUTSIDE;
    }
    for (side = 0U; (status == %NAME%_OK) && (side < %NAME%_SIDES); side++)
    {
        const float over = (%name%_sides_f[3U * side] * px) +
                           (%name%_sides_f[(3U * side) + 1U] * py) +
                           %name%_sides_f[(3U * side) + 2U];
        if (over > 0.0F)
        {
            status = %NAME%_OUTSIDE;
        }
    }
    if (status == %NAME%_OK)
    {
        const uint32_t column = corner_of((int32_t)px, %NAME%_COLUMNS);
        const uint32_t row = corner_of((int32_t)py, %NAME%_ROWS);
        float wx[4];
        float wy[4];
        float sx = 0.0F;
        float sy = 0.0F;
        float square;
        uint32_t i;
        uint32_t j;

        weights_f(px - (float)column, wx);
        weights_f(py - (float)row, wy);
        for (j = 0U; j < 4U; j++)
        {
            float row_x = 0.0F;
            float row_y = 0.0F;
            for (i = 0U; i < 4U; i++)
            {
                const uint32_t at =
                    ((((row + j) - 1U) * %NAME%_COLUMNS) + ((column + i) - 1U)) * 2U;
                row_x += wx[i] * %name%_nodes_f[at];
                row_y += wx[i] * %name%_nodes_f[at + 1U];
            }
            sx += wy[j] * row_x;
            sy += wy[j] * row_y;
        }
        square = (sx * sx) + (sy * sy);
        if (square >= 1.0F)
        {
            status = %NAME%_OUTSIDE;
        }
        else
        {
            sun[0] = sx;
            sun[1] = sy;
            sun[2] = sqrtf(1.0F - square);
        }
    }
    return status;
}

/* A number divided by 65536, rounded to the nearest. */
static int64_t scaled(int64_t number)
{
    const int64_t half = 32768;
    const int64_t one = 65536;

    return (number >= 0) ? ((number + half) / one) : ((number - half) / one);
}

static void weights_q(int64_t t_q16, int64_t w_q16[4])
{
    const int64_t one = 65536;
    const int64_t t2 = scaled(t_q16 * t_q16);
    const int64_t t3 = scaled(t2 * t_q16);

    w_q16[0] = ((-t3 + (2 * t2)) - t_q16) / 2;
    w_q16[1] = (((3 * t3) - (5 * t2)) / 2) + one;
    w_q16[2] = (((-3 * t3) + (4 * t2)) + t_q16) / 2;
    /* so that they add up to one */
    w_q16[3] = one - (w_q16[0] + w_q16[1] + w_q16[2]);
}

/* Largest whole number whose square is no more. */
static uint32_t root(uint64_t square)
{
    uint64_t rest = square;
    uint64_t found = 0U;
    uint64_t bit = (uint64_t)1U << 62U;

    while (bit > rest)
    {
        bit >>= 2U;
    }
    while (bit != 0U)
    {
        if (rest >= (found + bit))
        {
            rest -= found + bit;
            found = (found >> 1U) + bit;
        }
        else
        {
            found >>= 1U;
        }
        bit >>= 2U;
    }
    return (uint32_t)found;
}

%name%_status_t %name%_sun_q(int32_t x_q16, int32_t y_q16, int32_t sun_q30[3])
{
    %name%_status_t status = %NAME%_OK;
    const int64_t one = 65536;
    const int64_t x = (int64_t)x_q16;
    const int64_t y = (int64_t)y_q16;
    uint32_t side;

    sun_q30[0] = 0;
    sun_q30[1] = 0;
    sun_q30[2] = 0;
    if ((x < 0) || (x > (((int64_t)%NAME%_COLUMNS - 1) * one)) ||
        (y < 0) || (y > (((int64_t)%NAME%_ROWS - 1) * one)))
    {
        status = %NAME%_OUTSIDE;
    }
    for (side = 0U; (status == %NAME%_OK) && (side < %NAME%_SIDES); side++)
    {
        const int64_t over = scaled((int64_t)%name%_sides_q16[3U * side] * x) +
                             scaled((int64_t)%name%_sides_q16[(3U * side) + 1U] * y) +
                             (int64_t)%name%_sides_q16[(3U * side) + 2U];
        if (over > 0)
        {
            status = %NAME%_OUTSIDE;
        }
    }
    if (status == %NAME%_OK)
    {
        const uint32_t column = corner_of((int32_t)(x / one), %NAME%_COLUMNS);
        const uint32_t row = corner_of((int32_t)(y / one), %NAME%_ROWS);
        const int64_t unit = INT64_C(1152921504606846976); /* one in Q60 */
        int64_t wx[4];
        int64_t wy[4];
        int64_t sx = 0;
        int64_t sy = 0;
        int64_t left;
        uint32_t i;
        uint32_t j;

        weights_q(x - ((int64_t)column * one), wx);
        weights_q(y - ((int64_t)row * one), wy);
        for (j = 0U; j < 4U; j++)
        {
            int64_t row_x = 0;
            int64_t row_y = 0;
            for (i = 0U; i < 4U; i++)
            {
                const uint32_t at =
                    ((((row + j) - 1U) * %NAME%_COLUMNS) + ((column + i) - 1U)) * 2U;
                row_x += wx[i] * (int64_t)%name%_nodes_q30[at];
                row_y += wx[i] * (int64_t)%name%_nodes_q30[at + 1U];
            }
            sx += scaled(wy[j] * scaled(row_x));
            sy += scaled(wy[j] * scaled(row_y));
        }
        left = unit - ((sx * sx) + (sy * sy));
        if (left <= 0)
        {
            status = %NAME%_OUTSIDE;
        }
        else
        {
            sun_q30[0] = (int32_t)sx;
            sun_q30[1] = (int32_t)sy;
            sun_q30[2] = (int32_t)root((uint64_t)left);
        }
    }
    return status;
}
"""

_TABLE = """/* Numbers of %name%.h; load them as a table of the flight executive, or link them. */
#include "%name%.h"

@DATA@
"""

_VECTORS_H = """/* Readings with the directions that the calibration's software gives for them. */
#ifndef %NAME%_VECTORS_H
#define %NAME%_VECTORS_H

#define %NAME%_VECTORS (%vectors%U)

typedef struct
{
    float x;
    float y;
    float sun_x;
    float sun_y;
    float sun_z;
    int valid;
} %name%_vector_t;

static const %name%_vector_t %name%_vectors[%NAME%_VECTORS] =
{
@DATA@
};

#endif /* %NAME%_VECTORS_H */
"""

_SELFTEST = """/* Compares float and fixed point with the test vectors; exit status 0: all agree. */
#include "%name%.h"
#include "%name%_vectors.h"

#include <math.h>
#include <stdio.h>

static double apart_deg(const double a[3], const %name%_vector_t *v)
{
    const double x = (a[1] * (double)v->sun_z) - (a[2] * (double)v->sun_y);
    const double y = (a[2] * (double)v->sun_x) - (a[0] * (double)v->sun_z);
    const double z = (a[0] * (double)v->sun_y) - (a[1] * (double)v->sun_x);

    return sqrt((x * x) + (y * y) + (z * z)) * 57.29577951308232;
}

static int32_t cells(float reading, float low, float per)
{
    const double place = ((double)reading - (double)low) * (double)per * 65536.0;
    double bounded = place;

    if (bounded > 2147483000.0)
    {
        bounded = 2147483000.0;
    }
    if (bounded < -2147483000.0)
    {
        bounded = -2147483000.0;
    }
    return (int32_t)bounded;
}

int main(void)
{
    double worst_f = 0.0;
    double worst_q = 0.0;
    int wrong = 0;
    uint32_t at;

    for (at = 0U; at < %NAME%_VECTORS; at++)
    {
        const %name%_vector_t *v = &%name%_vectors[at];
        float sun[3];
        int32_t sun_q30[3];
        const %name%_status_t one = %name%_sun(v->x, v->y, sun);
        const %name%_status_t two = %name%_sun_q(
            cells(v->x, %NAME%_LOW_X, %NAME%_PER_X), cells(v->y, %NAME%_LOW_Y, %NAME%_PER_Y),
            sun_q30);

        const %name%_status_t expected = (v->valid != 0) ? %NAME%_OK : %NAME%_OUTSIDE;

        if ((one != expected) || (two != expected))
        {
            wrong++;
        }
        else if (v->valid != 0)
        {
            const double a[3] = { (double)sun[0], (double)sun[1], (double)sun[2] };
            const double b[3] = { (double)sun_q30[0] / 1073741824.0,
                                  (double)sun_q30[1] / 1073741824.0,
                                  (double)sun_q30[2] / 1073741824.0 };
            const double off_f = apart_deg(a, v);
            const double off_q = apart_deg(b, v);

            worst_f = (off_f > worst_f) ? off_f : worst_f;
            worst_q = (off_q > worst_q) ? off_q : worst_q;
        }
        else
        {
            /* outside for both, as it has to be */
        }
    }
    (void)printf("%u vectors, %d flags wrong, float within %.2e deg, "
                 "fixed point within %.2e deg\\n",
                 %NAME%_VECTORS, wrong, worst_f, worst_q);
    return ((wrong == 0) && (worst_f <= 1e-4) && (worst_q <= 0.01)) ? 0 : 1;
}
"""

_EXAMPLE = """/* Reads lines "x y" and prints the direction of each. */
#include "%name%.h"

#include <stdio.h>

int main(void)
{
    float x;
    float y;

    while (scanf("%f %f", &x, &y) == 2)
    {
        float sun[3];

        if (%name%_sun(x, y, sun) == %NAME%_OK)
        {
            (void)printf("%.7f %.7f %.7f\\n", (double)sun[0], (double)sun[1], (double)sun[2]);
        }
        else
        {
            (void)printf("outside\\n");
        }
    }
    return 0;
}
"""
