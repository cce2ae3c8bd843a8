"""Files that a calibration leaves: report, JSON, Python and C, all of them or none."""

from __future__ import annotations

import json
from pathlib import Path

from algorithms.calibration.documents import DIGEST
from api.calibrate.calibration import Calibration
from api.calibrate.documents import document, versions
from api.calibrate.flight.code import FlightCode, flight_code
from api.calibrate.flight.names import c_name
from api.calibrate.flight.program import NoCodeError
from api.calibrate.report import report
from files.atomic import replace_file


def products(found: Calibration, name: str, command: str = "") -> dict[str, str]:
    """Return the text of every file by its name.

    C and Python are left out where no code can stand for the model; ``NAME_no_code.txt`` says so.
    """
    prefix = c_name(name)
    held = document(found, command)
    made = {f"{prefix}.json": json.dumps(held, indent=1, allow_nan=False) + "\n"}
    code: FlightCode | None = None
    try:
        code = flight_code(found)
    except NoCodeError as error:
        made[f"{prefix}_no_code.txt"] = f"No code was written: {error}.\n"
    else:
        said = {
            "Files": ", ".join(found.sources),
            "Data SHA-256": found.digest,
            "Model": f"{found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out",
            "Verdict": f"{found.verdict.word}: {found.verdict.reason}",
            "Command": command,
            "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        }
        made |= code.files(prefix, said, held[DIGEST])
    made[f"{prefix}_report.html"] = report(found, command, code)
    return made


def write_products(found: Calibration, directory: Path, name: str, command: str = "") -> list[Path]:
    """Write every file, the report last; returns their paths.

    Everything is made before the first is written, and each is written whole or not at all.
    """
    texts = products(found, name, command)
    directory.mkdir(parents=True, exist_ok=True)
    paths = [directory / file for file in texts]
    for path, text in zip(paths, texts.values(), strict=True):
        replace_file(path, text)
    return paths
