"""Files that a calibration leaves: report, JSON, Python and C, all of them or none."""

from __future__ import annotations

import json
from pathlib import Path

from algorithms.contract import FeatureKind
from api.calibrate.calibration import Calibration
from api.calibrate.documents import document
from api.calibrate.flight.c_source import c_files, c_name
from api.calibrate.flight.channels import ChannelTable, channel_table
from api.calibrate.flight.channels_c import channel_files
from api.calibrate.flight.python_source import channels_module, python_module
from api.calibrate.flight.table import FlightTable, NoTableError, flight_table
from api.calibrate.one_axis.curve import AxisCurve
from api.calibrate.report import report
from files.atomic import replace_file


def products(found: Calibration, name: str, command: str = "") -> dict[str, str]:
    """Return the text of every file by its name.

    C and Python are left out where no table can stand for the model; ``NAME_no_code.txt`` says so.
    """
    prefix = c_name(name)
    made = {
        f"{prefix}.json": json.dumps(document(found, command), indent=1, allow_nan=False) + "\n"
    }
    table: FlightTable | ChannelTable | None = None
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
        said["Code"] = (
            f"{table.words}, which add {table.added_deg:.2g} deg RMS to the model "
            f"and at most {table.largest_deg:.2g} deg"
        )
        if isinstance(table, ChannelTable):
            made[f"{prefix}.py"] = channels_module(table, said)
            made |= channel_files(table, found.readings.features, prefix, said)
        else:
            made[f"{prefix}.py"] = python_module(table, said)
            made |= c_files(table, prefix, said)
    made[f"{prefix}_report.html"] = report(found, command, table)
    return made


def _table(found: Calibration) -> FlightTable | ChannelTable:
    features, context = found.readings.features, found.readings.context
    if isinstance(found.model, AxisCurve):
        raise NoTableError(
            "code for flight gives a direction of two angles, and this is a calibration of one "
            "axis: take the polynomial of the JSON document"
        )
    if found.readings.kind is FeatureKind.SIGNALS:
        return channel_table(found.model, features, context, found.chosen.rms_deg)
    return flight_table(found.model, features, context)


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
