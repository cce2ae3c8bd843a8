"""Guessing what columns are from their names; the reader can correct the guess."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Literal, TypeVar

from api.calibrate.settings import (
    DirectionSettings,
    Form,
    Kind,
    ReadingsSettings,
    RowSettings,
    SensorSettings,
    Settings,
)
from api.calibrate.table import Table, TableError

_Word = TypeVar("_Word", bound=str)

#: Patterns of names, tried in this order; each list gives one column a pattern.
_DIRECTIONS: tuple[tuple[Form, tuple[str, ...]], ...] = (
    (
        "vector",
        (
            r"(sun_?|s_?|u_?|n_?|dir(ection)?_?)x",
            r"(sun_?|s_?|u_?|n_?|dir(ection)?_?)y",
            r"(sun_?|s_?|u_?|n_?|dir(ection)?_?)z",
        ),
    ),
    (
        "azimuth-zenith",
        (r"(az|azimuth|phi)(_?(deg|rad))?", r"(zenith|polar|off_?axis|theta|cone)(_?(deg|rad))?"),
    ),
    ("azimuth-elevation", (r"(az|azimuth)(_?(deg|rad))?", r"(el|elev|elevation)(_?(deg|rad))?")),
    ("projection", (r"alpha(_?(deg|rad))?", r"beta(_?(deg|rad))?")),
    (
        "alpha-inner",
        (
            r"(inner|pitch|rot_?x|theta_?x|angle_?x|tilt_?x|x_?(deg|rad))(_?(deg|rad))?",
            r"(outer|yaw|rot_?y|theta_?y|angle_?y|tilt_?y|y_?(deg|rad))(_?(deg|rad))?",
        ),
    ),
)
_READINGS: tuple[tuple[Kind, tuple[str, ...]], ...] = (
    ("frames", (r"(frame|image|picture|photo)(_?(file|name|path))?|file_?name",)),
    (
        "balance",
        (
            r"(balance_?x|s_?a|sx_?bal|fx|x_?balance|ratio_?x)",
            r"(balance_?y|s_?b|fy|y_?balance|ratio_?y)",
        ),
    ),
    (
        "spot",
        (
            r"(spot_?|centroid_?|c_?)?x(_?px|_?mm|_?pix(el)?)?|u_px|col(umn)?",
            r"(spot_?|centroid_?|c_?)?y(_?px|_?mm|_?pix(el)?)?|v_px|row_px",
        ),
    ),
    (
        "electrodes",
        (
            r"(i_?|v_?)?x_?(1|p|plus|pos|\+)",
            r"(i_?|v_?)?x_?(2|m|minus|neg|n|-)",
            r"(i_?|v_?)?y_?(1|p|plus|pos|\+)",
            r"(i_?|v_?)?y_?(2|m|minus|neg|n|-)",
        ),
    ),
    (
        "quadrants",
        (
            r"(q|quad|v|i|ch)_?(1|a)",
            r"(q|quad|v|i|ch)_?(2|b)",
            r"(q|quad|v|i|ch)_?(3|c)",
            r"(q|quad|v|i|ch)_?(4|d)",
        ),
    ),
)
_RUN, _TIME = r"(run|series|sweep|file)(_?(id|no|number))?", r"(t|time)(_?s)?|seconds"
_TEMPERATURE = r"(temp|temperature)(_?(k|c|deg_?c|celsius|kelvin))?"
#: Unit normals of faces by what their channel's name ends in.
_FACES = {
    "xp": (1.0, 0.0, 0.0),
    "xm": (-1.0, 0.0, 0.0),
    "yp": (0.0, 1.0, 0.0),
    "ym": (0.0, -1.0, 0.0),
    "zp": (0.0, 0.0, 1.0),
    "zm": (0.0, 0.0, -1.0),
}
_FACE = re.compile(
    r"(?:.*_)?(?:([xyz])_?(p|plus|pos|\+|m|minus|neg|n|-)|([+-])([xyz]))$", re.IGNORECASE
)
_CHANNEL = re.compile(r"(q|ch|channel|i|v|pd|cell|face|s|adc|p)_?\d+$", re.IGNORECASE)


def guess(table: Table) -> Settings:
    """Return settings guessed from the names of a table's columns; TableError where none fit."""
    names = list(table.columns)
    form, directions = _first(_DIRECTIONS, names)
    if form is None:
        raise TableError(
            f"{table.source}: no columns of the light's direction among {', '.join(names)}; "
            "expected sun_x, sun_y, sun_z, or alpha, beta, or azimuth, elevation; name them in a "
            "config (--init writes one)"
        )
    rest = [name for name in names if name not in directions]
    run, time_s, temperature = (_match(p, rest) for p in (_RUN, _TIME, _TEMPERATURE))
    rest = [name for name in rest if name not in (run, time_s, temperature)]
    faces = [name for name in rest if _face(name)]
    channels = [name for name in rest if _CHANNEL.fullmatch(name)]
    kind, readings = _first(_READINGS, rest)
    normals = None
    if len(faces) > 4:
        kind, readings = "channels", tuple(faces)
        normals = tuple(normal for name in faces if (normal := _face(name)) is not None)
    elif len(channels) > 4 and len(channels) > len(readings):
        kind, readings = "channels", tuple(channels)
    if kind is None:
        raise TableError(
            f"{table.source}: no columns of readings recognised among {', '.join(rest) or 'none'}; "
            "name them in a config (--init writes one)"
        )
    unit: Literal["deg", "rad"] = (
        "rad" if any(name.lower().endswith("rad") for name in directions) else "deg"
    )
    return Settings(
        readings=ReadingsSettings(kind=kind, columns=readings),
        direction=DirectionSettings(columns=directions, form=form, unit=unit),
        rows=RowSettings(run=run, time_s=time_s, temperature_K=temperature),
        sensor=SensorSettings(face_normals=normals),
    )


def _first(
    patterns: Sequence[tuple[_Word, tuple[str, ...]]], names: Sequence[str]
) -> tuple[_Word | None, tuple[str, ...]]:
    """Return the first entry whose patterns each match another name, with these names."""
    for word, wanted in patterns:
        found: list[str] = []
        for pattern in wanted:
            match = _match(pattern, [name for name in names if name not in found])
            if match is None:
                break
            found.append(match)
        if len(found) == len(wanted):
            return word, tuple(found)
    return None, ()


def _match(pattern: str, names: Sequence[str]) -> str | None:
    whole = re.compile(pattern, re.IGNORECASE)
    return next((name for name in names if whole.fullmatch(name)), None)


def _face(name: str) -> tuple[float, float, float] | None:
    match = _FACE.fullmatch(name)
    if match is None:
        return None
    axis = (match[1] or match[4]).lower()
    sign = "p" if (match[2] or match[3]).lower() in ("p", "plus", "pos", "+") else "m"
    return _FACES[axis + sign]
