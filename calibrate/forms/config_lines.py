"""Lines of a config that say what columns are, for messages."""

from __future__ import annotations

import json
from collections.abc import Sequence

from calibrate.settings import DirectionSettings, ReadingsSettings


def by_order(names: Sequence[str]) -> tuple[ReadingsSettings, DirectionSettings]:
    """Return settings of columns by their order: the last two are angles, those before readings."""
    if len(names) < 4:
        return (
            ReadingsSettings(kind="spot", columns=tuple(names[:1])),
            DirectionSettings(columns=tuple(names[-1:]), form="one-angle"),
        )
    readings = tuple(names[:-2])
    return (
        ReadingsSettings(kind="spot" if len(readings) == 2 else "channels", columns=readings),
        DirectionSettings(columns=tuple(names[-2:]), form="alpha-inner"),
    )


def config_lines(readings: ReadingsSettings, direction: DirectionSettings) -> str:
    """Return the lines of a config that say what columns are."""
    units = f', unit = "{direction.unit}"' if isinstance(direction.unit, str) else ""
    return (
        "say in a config (--init writes one) "
        f'readings = {{kind = "{readings.kind}", columns = {_listed(readings.columns)}}} and '
        f'direction = {{form = "{direction.form}", columns = {_listed(direction.columns)}{units}}}'
    )


def _listed(names: Sequence[str]) -> str:
    return "[" + ", ".join(json.dumps(name, ensure_ascii=False) for name in names) + "]"
