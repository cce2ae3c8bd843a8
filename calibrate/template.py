"""A commented ``sensor.toml`` of every column of a file, for its reader; and a preview."""

from __future__ import annotations

import json
import textwrap
from pathlib import Path
from typing import Any

from calibrate.forms.units import named
from calibrate.roles import Understood, by_order, understood
from calibrate.settings import Settings
from calibrate.table import Table, TableError, read_table

#: Rows that a preview shows, and first values that a template does.
PREVIEWED, _FIRST = 5, 3


def preview(path: Path) -> dict[str, Any]:
    """Return what a file seems to hold, as plain data, for a reader to check.

    ``source``, ``rows`` (how many), ``columns`` (a list of ``name``, ``role``, ``unit`` and
    ``first``, the first five values as text; role and unit are None where not known), ``notes``
    (sentences on how the file was read), ``refused`` (why nothing was recognised; empty where it
    was) and ``config`` (the text that ``--init`` writes). TableError if the file is no table.
    """
    table = read_table(path)
    found, why = _understood(table)
    roles = {} if found is None else roles_of(found.settings)
    return {
        "source": table.source,
        "rows": len(table),
        "columns": [
            {
                "name": name,
                "role": roles.get(name),
                "unit": table.units.get(name),
                "first": _first_values(table, name, PREVIEWED),
            }
            for name in table.columns
        ],
        "notes": [*table.notes, *(() if found is None else found.notes)],
        "refused": why,
        "config": template_of(table),
    }


def roles_of(settings: Settings) -> dict[str, str]:
    """Return what each column that settings name is, in a few words."""
    readings, direction, rows = settings.readings, settings.direction, settings.rows
    found = {name: f"reading {at}: {readings.kind}" for at, name in enumerate(readings.columns, 1)}
    found |= {
        name: f"direction {at}: {direction.form}" for at, name in enumerate(direction.columns, 1)
    }
    for at, name in enumerate(direction.light_columns or (), 1):
        found[name] = f"light {at} in the outer frame"
    named_rows: tuple[tuple[str | None, str], ...] = (
        (rows.run, "run"),
        (rows.time_s, "time"),
        (rows.temperature_K, "temperature"),
    )
    found |= {name: word for name, word in named_rows if name is not None}
    if direction.light_by_date is not None:
        found[direction.light_by_date] = "date of the Sun's place"
    return found


def template_of(table: Table) -> str:
    """Return a commented config of a table, whether or not its columns are recognised.

    Every column stands in it with its unit and first values. Where nothing is recognised, columns
    are placed by their order, for the reader to correct.
    """
    found, why = _understood(table)
    lines = ["# Settings of `sunatlas calibrate`. Correct what is wrong."]
    if found is None:
        lines += [f"# {part}" for part in _wrapped(f"Not recognised: {why}")]
        lines += ["# The columns below are placed by their order alone: correct them."]
    lines += [f"# {part}" for note in table.notes for part in _wrapped(f"Read: {note}.")]
    if found is not None:
        lines += [f"# {part}" for note in found.notes for part in _wrapped(f"Guessed: {note}.")]
    lines += ["#", "# Columns of the file, their units and first values:"]
    lines += [_described(table, name) for name in table.columns]
    settings = _placed(table) if found is None else found.settings
    return "\n".join(lines) + "\n\n" + template(settings)


def template(settings: Settings) -> str:
    """Return settings as TOML text with a comment above each; unset ones are commented out."""
    lines = [
        "# Changes of the axes before anything is fitted, in order: swap-xy, mirror-x, mirror-y,",
        "# rotate-90, rotate-180, rotate-270, swap-negated-xy.",
        f"apply = {_value(settings.apply)}",
    ]
    for name, section in Settings.model_fields.items():
        values = getattr(settings, name)
        if name == "apply":
            continue
        lines += ["", f"# {section.description}", f"[{name}]"]
        for field, about in type(values).model_fields.items():
            if about.description:
                lines += [f"# {part}" for part in _wrapped(about.description)]
            value = getattr(values, field)
            lines.append(f"# {field} = " if value is None else f"{field} = {_value(value)}")
    return "\n".join(lines) + "\n"


def _placed(table: Table) -> Settings:
    """Return settings of a table's columns by their order; those that hold text come last."""
    names = [name for name in table.columns if name not in table.unread]
    readings, direction = by_order(names or list(table.columns))
    return Settings(readings=readings, direction=direction)


def _understood(table: Table) -> tuple[Understood | None, str]:
    try:
        return understood(table), ""
    except TableError as error:
        return None, str(error)


def _described(table: Table, name: str) -> str:
    unit = table.units.get(name) or named(name).unit
    first = ", ".join(_first_values(table, name, _FIRST))
    return (
        f"#   {json.dumps(name, ensure_ascii=False)}"
        + (f" in {unit}" if unit else "")
        + (f": {first}, ...")
    )


def _first_values(table: Table, name: str, count: int) -> list[str]:
    column = table.columns[name][:count]
    return [f"{one:.10g}" if column.dtype.kind == "f" else str(one)[:60] for one in column]


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return "[" + ", ".join(_value(one) for one in value) + "]"
    return json.dumps(value, ensure_ascii=False)


def _wrapped(text: str) -> list[str]:
    return textwrap.wrap(text, 96, break_on_hyphens=False, break_long_words=False)
