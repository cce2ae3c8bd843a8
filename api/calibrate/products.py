"""Files that a calibration leaves: report, JSON, Python, C and certificate, all of them or none."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from algorithms.calibration.documents import DIGEST
from api.calibrate.calibration import Calibration
from api.calibrate.certificate.certificate import certificate
from api.calibrate.documents import document, versions
from api.calibrate.flight.code import FlightCode, flight_code
from api.calibrate.flight.names import c_name
from api.calibrate.flight.program import NoCodeError
from api.calibrate.one_axis.curve import AxisCurve
from api.calibrate.report.page import Asked, report
from files.directories import replace_in_directory

#: Ends of the names that were written before there was a list of them.
_ENDS = (
    *(".json", ".py", ".h", ".c", "_table.c", "_vectors.h", "_selftest.c", "_example.c"),
    *("_report.html", "_no_code.txt"),
)


def products(
    found: Calibration,
    name: str,
    command: str = "",
    asked: Asked | None = None,
    *,
    tell: Callable[[str], None] = lambda _: None,
) -> dict[str, str]:
    """Return the text of every file by its name.

    C and Python are left out where no code can stand for the model; ``NAME_no_code.txt`` says so.
    ``NAME.sha256`` lists the others with their digests, as ``sha256sum --check`` reads them.
    `tell` gets a sentence of what the code adds to the model, or why there is none.
    """
    prefix = c_name(name)
    held = document(found, command)
    made = {f"{prefix}.json": json.dumps(held, indent=1, allow_nan=False) + "\n"}
    code = ""
    try:
        made_code = _code(found)
    except NoCodeError as error:
        made[f"{prefix}_no_code.txt"] = f"No code was written: {error}.\n"
        tell(f"none: {error}")
    else:
        code = made_code.sentence
        tell(code)
        said = {
            "Files": ", ".join(found.sources),
            "Data SHA-256": found.digest,
            "Model": f"{found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out",
            "Verdict": f"{found.verdict.word}: {found.verdict.reason}",
            "Readings": _readings(found),
            "Command": command,
            "Versions": ", ".join(f"{name} {number}" for name, number in versions().items()),
        }
        made |= made_code.files(prefix, said, held[DIGEST])
    if asked is not None and asked.certificate:
        made[asked.certificate] = certificate(found, command)
    made[f"{prefix}_report.html"] = report(found, command, code, asked or Asked())
    return made | {f"{prefix}.sha256": _listed(made)}


def _code(found: Calibration) -> FlightCode:
    if isinstance(found.model, AxisCurve):
        raise NoCodeError(
            "code for flight gives a direction of two angles, and this is a calibration of one "
            "axis: take the polynomial of the JSON document"
        )
    return flight_code(found)


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
    asked: Asked | None = None,
    *,
    tell: Callable[[str], None] = lambda _: None,
) -> list[Path]:
    """Write every file, all of them or none; returns their paths.

    Everything is made before the first is written, and takes its place in one step
    (`files.directories`): who is killed leaves the files of the calibration before, or these.

    Raises
    ------
    UnreplaceableDirectoryError
        If the directory cannot be replaced as a whole.
    OSError
        If it cannot be written.
    """
    return write_set(products(found, name, command, asked, tell=tell), directory, name)


def write_set(texts: Mapping[str, str], directory: Path, name: str) -> list[Path]:
    """Write files of a calibration in place of those of the calibration before; returns paths."""
    prefix = c_name(name)
    files = {name: text.encode() for name, text in texts.items()}
    replace_in_directory(directory, files, _before(directory, prefix))
    return [directory / name for name in texts]


def _listed(texts: Mapping[str, str]) -> str:
    digests = {name: hashlib.sha256(text.encode()).hexdigest() for name, text in texts.items()}
    return "".join(f"{digest}  {name}\n" for name, digest in digests.items())


def _before(directory: Path, prefix: str) -> set[str]:
    """Return the names that the calibration before wrote."""
    listed = directory / f"{prefix}.sha256"
    names = {prefix + end for end in _ENDS}
    if listed.is_file():
        lines = listed.read_text("utf-8", errors="replace").splitlines()
        names |= {line.partition("  ")[2] for line in lines}
    return {name for name in names if name and Path(name).name == name}
