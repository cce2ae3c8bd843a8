"""One good table in many forms: each reads as the plain one, or by the lines its refusal names."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import openpyxl
import pandas as pd
import pytest
from bench import CENTRE, FOCAL, grid, sun_of
from scipy.spatial.transform import Rotation

from calibrate.readings import Readings, readings_of
from calibrate.roles import guess
from calibrate.settings import parse_settings
from calibrate.table import Table, TableError, read_table
from calibrate.template import template_of

ANGLES = grid(7, 40.0) + np.array([0.125, -0.25])
SUN = sun_of(ANGLES)
SPOTS = (CENTRE + FOCAL * SUN[:, :2] / SUN[:, 2:]).round(6)
NAMES = ["x_px", "y_px", "theta_x_deg", "theta_y_deg"]
ROWS = np.column_stack([SPOTS, ANGLES])
Maker = Callable[[Path], Path]


def text(
    names: list[str] | None = None,
    rows: np.ndarray | list[list[str]] = ROWS,
    *,
    sign: str = ",",
    decimal: str = ".",
    before: str = "",
    after_header: str = "",
    end: str = "\n",
    row_end: str = "",
    encoding: str = "utf-8",
    suffix: str = ".csv",
) -> Maker:
    """A maker of a text file."""
    cells = [
        [v if isinstance(v, str) else f"{v:.9f}".replace(".", decimal) for v in r] for r in rows
    ]
    lines = [] if names == [] else [sign.join(names or NAMES) + after_header]
    body = before + end.join([*lines, *(sign.join(row) + row_end for row in cells)]) + end

    def made(directory: Path) -> Path:
        path = directory / f"bench{suffix}"
        path.write_bytes(body.encode(encoding))
        return path

    return made


def with_angles(values: np.ndarray, names: list[str]) -> Maker:
    return text([*NAMES[:2], *names], np.column_stack([SPOTS, values]))


def with_cells(cells: list[list[str]], names: list[str] | None = None, **more: str) -> Maker:
    """A file whose angles are spelt otherwise."""
    rows = [[f"{x:.9f}", f"{y:.9f}", *row] for (x, y), row in zip(SPOTS, cells, strict=True)]
    return text(names, rows, **more)  # type: ignore[arg-type]


def sexagesimal(value: float, signs: str) -> str:
    seconds = round(abs(value) * 3600.0, 3)
    whole, minutes = int(seconds // 3600), int(seconds % 3600 // 60)
    d, m, s = signs
    return f"{'-' if value < 0 else ''}{whole}{d}{minutes:02d}{m}{seconds % 60:06.3f}{s}".rstrip()


def workbook(*sheets: tuple[str, list[list[object]]]) -> Maker:
    def made(directory: Path) -> Path:
        path = directory / "bench.xlsx"
        book = openpyxl.Workbook()
        book.remove(book.active)
        for name, rows in sheets:
            sheet = book.create_sheet(name)
            for row in rows:
                sheet.append(row)
        book.save(path)
        return path

    return made


def parquet(directory: Path) -> Path:
    path = directory / "bench.parquet"
    pd.DataFrame(ROWS, columns=NAMES).astype(str).map(str.encode).to_parquet(path)
    return path


def savetxt(**said: str) -> Maker:
    def made(directory: Path) -> Path:
        np.savetxt(directory / "bench.txt", ROWS, **said)  # type: ignore[arg-type]
        return directory / "bench.txt"

    return made


def dms(signs: str) -> Maker:
    return with_cells([[sexagesimal(v, signs) for v in row] for row in ANGLES])


def extra(name: str, values: list[str]) -> Maker:
    rows = [[v, *(f"{c:.9f}" for c in row)] for v, row in zip(values, ROWS, strict=True)]
    return text([name, *NAMES], rows)


COUNT = len(ROWS)
# the light is along z where the table is at rest: y about the outer axis, x about the inner one
ATTITUDES = Rotation.concatenate(
    [
        Rotation.from_euler("y", b, degrees=True) * Rotation.from_euler("x", -a, degrees=True)
        for a, b in ANGLES
    ]
)
QUATERNIONS, MATRICES = ATTITUDES.as_quat(), ATTITUDES.as_matrix().reshape(-1, 9)
NINE = [f"r{i}{j}" for i in "123" for j in "123"]
STAMPS = [f"2026-03-02T10:{n // 60:02d}:{n % 60:02d}" for n in range(COUNT)]

READ_AS_THEY_ARE: dict[str, Maker] = {
    "plain": text(),
    "tabs": text(sign="\t", suffix=".tsv"),
    "bars": text(sign="|"),
    "blanks": text(sign="   ", suffix=".txt"),
    "semicolons and decimal commas": text(sign=";", decimal=","),
    "tabs and decimal commas": text(sign="\t", decimal=","),
    "a blank behind each comma": text(sign=", "),
    "UTF-8 with a mark": text(encoding="utf-8-sig"),
    "UTF-16": text(encoding="utf-16"),
    "UTF-16 without a mark": text(encoding="utf-16-le"),
    "UTF-32": text(encoding="utf-32"),
    "Latin-1 degree sign": text([*NAMES[:2], "theta_x [°]", "theta_y [°]"], encoding="latin-1"),
    "Macintosh degree sign": text([*NAMES[:2], "theta_x (°)", "theta_y (°)"], encoding="mac_roman"),
    "DOS degree sign": text([*NAMES[:2], "theta_x °", "theta_y °"], encoding="cp850"),
    "line ends of Windows": text(end="\r\n"),
    "line ends of old Macintoshes": text(end="\r"),
    "comments of percent signs": text(before="% bench 3\n% 2026-03-02, lamp A\n"),
    "comments of slashes": text(before="// made by hand\n"),
    "title rows": text(before="Sun sensor, unit 7\noperator B\n\n"),
    "a group header": text(before="spot,,table,\n"),
    "a row of units": text(["x", "y", "theta_x", "theta_y"], after_header="\npx,px,deg,deg"),
    "a row of units in brackets": text(
        ["x", "y", "theta_x", "theta_y"], after_header="\n[px],[px],[deg],[deg]"
    ),
    "units in brackets": text(["X [px]", "Y [px]", "Theta X [deg]", "Theta Y [deg]"]),
    "units behind a slash": text(["x/px", "y/px", "theta_x / deg", "theta_y / deg"]),
    "a header in a comment": text(before="# ", suffix=".txt"),
    "savetxt with a header": savetxt(header=" ".join(NAMES)),
    "savetxt with commas": savetxt(header=",".join(NAMES), delimiter=","),
    "milliradians": with_angles(np.radians(ANGLES) * 1e3, ["theta_x_mrad", "theta_y_mrad"]),
    "minutes of arc": with_angles(ANGLES * 60.0, ["theta_x [arcmin]", "theta_y [arcmin]"]),
    "seconds of arc": with_angles(ANGLES * 3600.0, ["theta_x_arcsec", "theta_y_arcsec"]),
    "gon": with_angles(ANGLES / 0.9, ["theta_x (gon)", "theta_y (gon)"]),
    "radians": with_angles(np.radians(ANGLES), ["theta_x_rad", "theta_y_rad"]),
    "two units": with_angles(ANGLES * [1.0, np.pi / 180.0], ["theta_x_deg", "theta_y_rad"]),
    "degrees, minutes and seconds": dms("°'\""),
    "degrees, minutes and seconds with colons": dms(":: "),
    "degrees, minutes and seconds with letters": dms("dms"),
    "units in cells": with_cells([[f"{v:.6f} deg" for v in row] for row in ANGLES]),
    "minus signs of typesetters": with_cells(
        [[f"{v:.6f}".replace("-", "\u2212") for v in row] for row in ANGLES]
    ),
    "a date named time": extra("time", STAMPS),
    "a date of days first": extra("date", [f"02.03.2026 10:00:{n:02d}" for n in range(COUNT)]),
    "seconds since 1970": extra("time", [str(1_772_445_600 + n) for n in range(COUNT)]),
    "a clock that nobody reads": extra("time", ["just now"] * COUNT),
    "trailing commas": text(after_header=",", row_end=","),
    "trailing commas of the data alone": text(row_end=","),
    "an unnamed index": extra("", [str(n) for n in range(COUNT)]),
    "an index that the header leaves out": text(
        rows=[[str(n), *(f"{c:.9f}" for c in row)] for n, row in enumerate(ROWS, 1)]
    ),
    "quoted cells": text(
        [f'"{name}"' for name in NAMES], [[f'"{c:.9f}"' for c in row] for row in ROWS]
    ),
    "pan and tilt": with_angles(ANGLES[:, ::-1], ["pan_deg", "tilt_deg"]),
    "yaw and pitch": with_angles(ANGLES[:, ::-1], ["yaw", "pitch"]),
    "gimbals": with_angles(ANGLES, ["gimbal_inner", "gimbal_outer"]),
    "angles of free names": with_angles(ANGLES, ["goniometer [deg]", "rotary stage [deg]"]),
    "vectors": with_angles(SUN, ["sun_x", "sun_y", "sun_z"]),
    "vectors of a body": with_angles(SUN, ["sun_body_x", "sun_body_y", "sun_body_z"]),
    "vectors from the Sun": with_angles(-SUN, ["sun_x", "sun_y", "sun_z"]),
    "vectors named from the Sun": with_angles(-SUN, ["from_sun_x", "from_sun_y", "from_sun_z"]),
    "quaternions, scalar last": with_angles(QUATERNIONS, ["qx", "qy", "qz", "qw"]),
    "quaternions, scalar first": with_angles(
        np.roll(QUATERNIONS, 1, axis=1), ["q_w", "q_x", "q_y", "q_z"]
    ),
    "numbered quaternions": with_angles(np.roll(QUATERNIONS, 1, axis=1), ["q0", "q1", "q2", "q3"]),
    "quaternions the other way": with_angles(
        ATTITUDES.inv().as_quat(), ["quat_x", "quat_y", "quat_z", "quat_w"]
    ),
    "matrices": with_angles(MATRICES, NINE),
    "matrices the other way": with_angles(ATTITUDES.inv().as_matrix().reshape(-1, 9), NINE),
    "a workbook with title rows and units": workbook(
        ("Data", [["unit 7"], [], NAMES, ["px", "px", "deg", "deg"], *ROWS.tolist()])
    ),
    "the second sheet": workbook(
        ("Notes", [["made by hand"], ["lamp", "A"]]), ("Run", [NAMES, *ROWS.tolist()])
    ),
    "bytes in Parquet": parquet,
}
BY_LINES: dict[str, Maker] = {
    "savetxt without a header": savetxt(),
    "no header": text([]),
    "names that say nothing": text(["a1", "b1", "c1", "e1"]),
    "names in another alphabet": text(["икс", "игрек", "тета1", "тета2"]),
}


def plain_of(readings: Readings) -> None:
    """Assert that samples are those of the plain table."""
    assert len(readings) == COUNT
    assert readings.features == pytest.approx(SPOTS, abs=1e-6)
    assert readings.sun == pytest.approx(SUN, abs=2e-8)


@pytest.mark.parametrize("form", READ_AS_THEY_ARE)
def test_a_form_reads_as_the_plain_table(form: str, tmp_path: Path) -> None:
    table = read_table(READ_AS_THEY_ARE[form](tmp_path))
    plain_of(readings_of(table, guess(table)))


@pytest.mark.parametrize("form", [*READ_AS_THEY_ARE][::6])
def test_the_config_that_init_writes_reads_the_same(form: str, tmp_path: Path) -> None:
    table = read_table(READ_AS_THEY_ARE[form](tmp_path))
    written = template_of(table)
    settings = parse_settings(tomllib.loads(written), "sensor.toml")
    assert settings == guess(table)
    assert all(f'"{name}"' in written for name in table.columns)


@pytest.mark.parametrize("form", BY_LINES)
def test_a_refusal_names_the_lines_that_read_the_file(form: str, tmp_path: Path) -> None:
    table = read_table(BY_LINES[form](tmp_path))
    with pytest.raises(TableError, match="say in a config") as refusal:
        guess(table)
    lines = re.findall(r"(?:readings|direction) = \{.*?\}", str(refusal.value))
    settings = parse_settings(tomllib.loads("\n".join(lines)), "sensor.toml")
    plain_of(readings_of(table, settings))


def test_the_table_says_how_it_was_read(tmp_path: Path) -> None:
    made = text(
        ["x", "y", "theta_x", "theta_y"], sign=";", decimal=",", encoding="utf-16",
        before="unit 7\n# by hand\n", after_header="\npx;px;deg;deg",
    )  # fmt: skip
    assert read_table(made(tmp_path)).notes == (
        "text in UTF-16, cells separated by semicolons",
        "numbers have decimal commas",
        "the header is row 3",
        "row 4 holds units",
        "1 comment line left out",
    )


def test_rows_keep_their_numbers_behind_comments_and_blank_lines(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_text("# a\nx_px,y_px,alpha,beta\n1,2,3,4\n\n# b\n5,6,7,8\n9,b,3,4\n")
    table = read_table(path)
    assert table.rows.tolist() == [3, 6, 7]
    with pytest.raises(TableError, match="row 7, column y_px: expected a number; got 'b'"):
        table.numbers("y_px")


def context_of(maker: Maker, tmp_path: Path) -> tuple[Table, dict[str, np.ndarray]]:
    table = read_table(maker(tmp_path))
    return table, dict(readings_of(table, guess(table)).context)


@pytest.mark.parametrize(
    ("name", "values", "kelvin"),
    [
        ("temp_C", 20.0, 293.15),
        ("temperature [K]", 293.15, 293.15),
        ("T [°C]", 20.0, 293.15),
        ("temp_degF", 68.0, 293.15),
        ("temperature", 20.0, 293.15),
        ("temperature", 293.15, 293.15),
    ],
)
def test_temperatures_are_kelvin_by_their_unit_or_size(
    name: str, values: float, kelvin: float, tmp_path: Path
) -> None:
    _, context = context_of(extra(name, [f"{values:.3f}"] * COUNT), tmp_path)
    assert context["temperature_K"] == pytest.approx(np.full(COUNT, kelvin))


@pytest.mark.parametrize(
    ("name", "cells", "step"),
    [
        ("time", STAMPS, 1.0),
        ("time [ms]", [str(250 * n) for n in range(COUNT)], 0.25),
        ("timestamp", [str(1_772_445_600_000 + 20 * n) for n in range(COUNT)], 0.02),
        ("time", [f"10:{n // 60:02d}:{n % 60:02d}.5" for n in range(COUNT)], 1.0),
        ("jd", [f"{2461101.5 + n / 86400.0:.9f}" for n in range(COUNT)], 1.0),
    ],
)
def test_times_are_seconds_by_their_form(
    name: str, cells: list[str], step: float, tmp_path: Path
) -> None:
    _, context = context_of(extra(name, cells), tmp_path)
    assert np.diff(context["time_s"]) == pytest.approx(np.full(COUNT - 1, step), abs=2e-4)


def test_a_number_of_thousands_of_digits_is_no_number(tmp_path: Path) -> None:
    path = tmp_path / "bench.csv"
    path.write_text("x_px,y_px,alpha,beta\n1,2,3,4\n" + "1" * 19_000 + ",2,3,4\n")
    with pytest.raises(TableError, match="row 3, column x_px: expected a number; got '1111"):
        read_table(path).numbers("x_px")


def test_void_columns_are_refused_and_bytes_read(tmp_path: Path) -> None:
    np.savez(tmp_path / "void.npz", x_px=np.zeros(3, dtype="V8"))
    with pytest.raises(TableError, match=r"array x_px: expected numbers or text; got type \|V8"):
        read_table(tmp_path / "void.npz")
    np.savez(tmp_path / "bytes.npz", x_px=np.array([b"1.5", b"2.5"]))
    assert read_table(tmp_path / "bytes.npz").numbers("x_px").tolist() == [1.5, 2.5]
