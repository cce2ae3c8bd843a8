"""Files that a calibration leaves: report, JSON, Python, C and certificate, all of them or none."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from algorithms.contract import FeatureKind
from api.calibrate.calibration import Calibration
from api.calibrate.certificate.certificate import certificate
from api.calibrate.documents import document
from api.calibrate.flight.c_source import c_files, c_name
from api.calibrate.flight.channels import ChannelTable, channel_table
from api.calibrate.flight.channels_c import channel_files
from api.calibrate.flight.python_source import channels_module, python_module
from api.calibrate.flight.table import FlightTable, NoTableError, flight_table
from api.calibrate.report.page import Asked, report
from files.directories import replace_in_directory

#: Ends of the names that were written before there was a list of them.
_ENDS = (
    *(".json", ".py", ".h", ".c", "_table.c", "_vectors.h", "_selftest.c", "_example.c"),
    *("_report.html", "_no_code.txt"),
)


def products(
    found: Calibration, name: str, command: str = "", asked: Asked | None = None
) -> dict[str, str]:
    """Return the text of every file by its name.

    C and Python are left out where no table can stand for the model; ``NAME_no_code.txt`` says so.
    ``NAME.sha256`` lists the others with their digests, as ``sha256sum --check`` reads them.
    """
    prefix = c_name(name)
    made = {
        f"{prefix}.json": json.dumps(document(found, command), indent=1, allow_nan=False) + "\n"
    }
    code = ""
    said = {
        "Files": ", ".join(found.sources),
        "Data SHA-256": found.digest,
        "Model": f"{found.chosen.name}, {found.chosen.rms_deg:.3g} deg RMS on samples left out",
        "Verdict": f"{found.verdict.word}: {found.verdict.reason}",
        "Command": command,
    }
    try:
        table = _table(found)
    except NoTableError as error:
        made[f"{prefix}_no_code.txt"] = f"No code was written: {error}.\n"
    else:
        code = said["Code"] = (
            f"{table.words}, which add {table.added_deg:.2g} deg RMS to the model "
            f"and at most {table.largest_deg:.2g} deg"
        )
        if isinstance(table, ChannelTable):
            made[f"{prefix}.py"] = channels_module(table, said)
            made |= channel_files(table, found.readings.features, prefix, said)
        else:
            made[f"{prefix}.py"] = python_module(table, said)
            made |= c_files(table, prefix, said)
    if asked is not None and asked.certificate:
        made[asked.certificate] = certificate(found, command)
    made[f"{prefix}_report.html"] = report(found, command, code, asked or Asked())
    return made | {f"{prefix}.sha256": _listed(made)}


def _table(found: Calibration) -> FlightTable | ChannelTable:
    features, context = found.readings.features, found.readings.context
    if found.readings.kind is FeatureKind.SIGNALS:
        return channel_table(found.model, features, context, found.chosen.rms_deg)
    return flight_table(found.model, features, context)


def write_products(
    found: Calibration,
    directory: Path,
    name: str,
    command: str = "",
    asked: Asked | None = None,
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
    return write_set(products(found, name, command, asked), directory, name)


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
