"""Files that a calibration leaves: report, JSON, Python, C and certificate, all of them or none."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from algorithms.calibration.documents import DIGEST
from calibrate.calibration import Calibration
from calibrate.documents import (
    SavedCalibration,
    document,
    of_document,
    text_of,
    versions,
    with_correction,
)
from calibrate.flight.code import FlightCode, corrected_code, flight_code
from calibrate.flight.names import c_name
from calibrate.flight.program import NoCodeError
from calibrate.one_axis import AxisCurve
from calibrate.places import off_axis_deg
from calibrate.recalibration import Correction, poses_of
from calibrate.report.certificate import certificate
from calibrate.report.page import Asked, correction_report, outcomes_of, report
from calibrate.report.requirement import Judged, Requirement
from files.atomic import replace_in_directory

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
    code = _or_none(lambda: _code(found))
    program = None if isinstance(code, NoCodeError) else code.program
    held = document(found, command, program)
    said = {
        "Files": ", ".join(found.sources),
        "Data SHA-256": found.digest,
        "Model": f"{found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out",
        "Verdict": f"{found.verdict.word}: {found.verdict.reason}",
        "Readings": _readings(found),
    }
    made, sentence = _with_code(held, code, prefix, {**said, **_made_by(command)}, tell)
    if asked is not None and asked.certificate:
        made[asked.certificate] = certificate(found, command)
    made[f"{prefix}_report.html"] = report(found, command, sentence, asked or Asked())
    return made | {f"{prefix}.sha256": _listed(made)}


def corrected_products(  # noqa: PLR0917 - what a correction and its files are made of
    old: SavedCalibration,
    found: Correction,
    files: Sequence[Path],
    name: str,
    command: str = "",
    requirements: Sequence[Requirement] = (),
    *,
    tell: Callable[[str], None] = lambda _: None,
) -> tuple[dict[str, str], list[Judged]]:
    """Return the text of every file of a corrected calibration by its name, as `products` does.

    And for each requirement whether the poses of the correction meet it, each while left out.
    """
    prefix = c_name(name)
    held = with_correction(old, found, files, command)
    saved = of_document(held, prefix)
    poses = poses_of(files, saved)
    code = _or_none(lambda: corrected_code(saved, poses))
    said = {
        "Files": ", ".join(path.name for path in files),
        "Corrects": f"calibration with SHA-256 {old.document[DIGEST]}",
        "Correction": found.sentence(),
    }
    made, sentence = _with_code(held, code, prefix, {**said, **_made_by(command)}, tell)
    outcomes = outcomes_of(found, poses, requirements)
    made[f"{prefix}_report.html"] = correction_report(
        found, poses, outcomes, {**said, "Flight code": sentence or "none", **_made_by(command)}
    )
    return made | {f"{prefix}.sha256": _listed(made)}, outcomes


def _or_none(make: Callable[[], FlightCode]) -> FlightCode | NoCodeError:
    try:
        return make()
    except NoCodeError as error:
        return error


def _with_code(
    held: Mapping[str, Any],
    code: FlightCode | NoCodeError,
    prefix: str,
    said: Mapping[str, str],
    tell: Callable[[str], None],
) -> tuple[dict[str, str], str]:
    """Return the texts of a document and its code, and what is said of the code."""
    made = {f"{prefix}.json": text_of(held)}
    if isinstance(code, NoCodeError):
        made[f"{prefix}_no_code.txt"] = f"No code was written: {code}.\n"
        tell(f"none: {code}")
        return made, ""
    tell(code.sentence)
    return made | code.files(prefix, said, held[DIGEST]), code.sentence


def _made_by(command: str) -> dict[str, str]:
    numbers = ", ".join(f"{name} {number}" for name, number in versions().items())
    return {"Command": command, "Versions": numbers}


def _code(found: Calibration) -> FlightCode:
    if isinstance(found.model, AxisCurve):
        raise NoCodeError(
            "code for flight gives a direction of two angles, and this is a calibration of one "
            "axis: take the polynomial of the JSON document"
        )
    return flight_code(found)


def _readings(found: Calibration) -> str:
    """Say what readings are, what is done to them before the model, and the field."""
    stated, reach = found.settings.readings, off_axis_deg(found.readings.sun).max()
    turns = ", ".join(found.settings.apply) if stated.kind != "channels" else ""
    return (
        f"{stated.kind} of {', '.join(stated.columns)}"
        f"{', falling when light rises' if stated.inverted else ''}"
        f"{f'; axes: {turns}' if turns else ''}; calibrated up to {reach:.1f} deg off +z"
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
    (`files.atomic`): who is killed leaves the files of the calibration before, or these.
    UnreplaceableError if the directory cannot be replaced as a whole, OSError if not written.
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
