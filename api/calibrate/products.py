"""Files that a calibration leaves: report, JSON, Python and C, all of them or none."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np

from algorithms.calibration.documents import DIGEST
from api.calibrate.calibration import Calibration
from api.calibrate.documents import document, versions
from api.calibrate.flight.code import FlightCode, flight_code
from api.calibrate.flight.names import c_name
from api.calibrate.flight.program import NoCodeError
from api.calibrate.report import report
from files.atomic import replace_file


def products(
    found: Calibration,
    name: str,
    command: str = "",
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, str]:
    """Return the text of every file by its name.

    C and Python are left out where no code can stand for the model; ``NAME_no_code.txt`` says so.
    `tell` gets a sentence of what the code adds to the model, or why there is none.
    """
    prefix = c_name(name)
    held = document(found, command)
    made = {f"{prefix}.json": json.dumps(held, indent=1, allow_nan=False) + "\n"}
    code: FlightCode | None = None
    try:
        code = flight_code(found)
    except NoCodeError as error:
        made[f"{prefix}_no_code.txt"] = f"No code was written: {error}.\n"
        tell(f"none: {error}")
    else:
        tell(code.sentence)
        said = {
            "Files": ", ".join(found.sources),
            "Data SHA-256": found.digest,
            "Model": f"{found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out",
            "Verdict": f"{found.verdict.word}: {found.verdict.reason}",
            "Readings": _readings(found),
            "Command": command,
            "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        }
        made |= code.files(prefix, said, held[DIGEST])
    made[f"{prefix}_report.html"] = report(found, command, code)
    return made


def _readings(found: Calibration) -> str:
    """Say what readings are, what is done to them before the model, and the field."""
    stated, sun = found.settings.readings, found.readings.sun
    off = np.degrees(np.arctan2(np.hypot(sun[:, 0], sun[:, 1]), sun[:, 2]))
    turns = ", ".join(found.settings.apply) if stated.kind != "channels" else ""
    return (
        f"{stated.kind} of {', '.join(stated.columns)}"
        f"{', falling when light rises' if stated.inverted else ''}"
        f"{f'; axes: {turns}' if turns else ''}; calibrated up to {off.max():.1f} deg off +z"
    )


def write_products(
    found: Calibration,
    directory: Path,
    name: str,
    command: str = "",
    tell: Callable[[str], None] = lambda _: None,
) -> list[Path]:
    """Write every file, the report last; returns their paths.

    Everything is made before the first is written, and each is written whole or not at all.
    """
    texts = products(found, name, command, tell)
    directory.mkdir(parents=True, exist_ok=True)
    paths = [directory / file for file in texts]
    for path, text in zip(paths, texts.values(), strict=True):
        replace_file(path, text)
    return paths
