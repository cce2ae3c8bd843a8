"""A commented ``sensor.toml``, guessed from a file's header, for the reader to correct."""

from __future__ import annotations

import json

from pydantic import BaseModel

from api.calibrate.settings import (
    BenchSettings,
    CertificateSettings,
    DirectionSettings,
    ReadingsSettings,
    RowSettings,
    SensorSettings,
    Settings,
)

_TITLES = {
    "readings": "What the sensor read.",
    "direction": "Where the light was.",
    "rows": "What else is known of each row.",
    "bench": "The bench.",
    "sensor": "The drawing, as far as it is known; what is missing is estimated from the readings.",
    "certificate": "Who calibrated what for whom, for --certificate.",
}


def template(settings: Settings, names: list[str]) -> str:
    """Return settings as TOML text with a comment above each; unset ones are commented out."""
    lines = [
        "# Settings of `sunatlas calibrate`, guessed from the header. Correct what is wrong.",
        f"# Columns of the file: {', '.join(names)}",
        "",
        "# Changes of the axes before anything is fitted, in order: swap-xy, mirror-x, mirror-y,",
        "# rotate-90, rotate-180, rotate-270, swap-negated-xy.",
        f"apply = {_value(settings.apply)}",
    ]
    parts: dict[str, tuple[type[BaseModel], BaseModel]] = {
        "readings": (ReadingsSettings, settings.readings),
        "direction": (DirectionSettings, settings.direction),
        "rows": (RowSettings, settings.rows),
        "bench": (BenchSettings, settings.bench),
        "sensor": (SensorSettings, settings.sensor),
        "certificate": (CertificateSettings, settings.certificate),
    }
    for name, (kind, values) in parts.items():
        lines += ["", f"# {_TITLES[name]}", f"[{name}]"]
        for field, about in kind.model_fields.items():
            if about.description:
                lines += [f"# {part}" for part in _wrapped(about.description)]
            value = getattr(values, field)
            lines.append(f"# {field} = " if value is None else f"{field} = {_value(value)}")
    return "\n".join(lines) + "\n"


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_value(one) for one in value) + "]"
    return json.dumps(value)


def _wrapped(text: str) -> list[str]:
    import textwrap  # noqa: PLC0415 - one use

    return textwrap.wrap(text, 96)
