"""Statuses, 1-sigma by place, names and cost of flight code."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from raw_sensors import OTHERS, SENSORS, c_answers, compiled, module_of, written

from calibrate.causes.bad_cells import ReadingLimits
from calibrate.flight.code import flight_code
from calibrate.flight.names import c_name, comment
from calibrate.flight.program import run
from calibrate.uncertainty import Intervals

DIGEST = "0123456789abcdef0123456789abcdef"


@pytest.mark.parametrize("rounded", [0.0, 5e-7])
def test_readings_at_their_limits_are_saturated_by_the_column_of_the_settings(
    rounded: float, camera: Any
) -> None:
    sensor = SENSORS["quadrants"]
    found = sensor.calibrated(camera)
    # the first quadrant, which is the file's second column, is clipped below
    raw = sensor.raw(3)
    clipped = float(np.quantile(raw[:, 1], 0.3))
    stated = (1.0 - rounded) * clipped  # as a file's last digit has it
    limits = ReadingLimits((stated, -np.inf, -np.inf, -np.inf), (np.inf,) * 4, 0.1, 100.0)
    code = flight_code(replace(found, limits=limits))
    _, _, status = run(code.program.steps, raw)
    assert np.array_equal(status == 3, raw[:, 1] <= clipped)
    assert (status == 3).mean() == pytest.approx(0.3, abs=0.01)
    header = " ".join(code.files("ss", {}, DIGEST)["ss.h"].replace("*", "").split())
    said = re.search(r"column q1, in its unit; dark 4.8, gain -1, clipped at (\S+) and", header)
    assert said
    assert float(said[1]) == pytest.approx(clipped, rel=1e-5)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="no C compiler here")
@pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (0.6, 0.0, 0.8)])
def test_one_sigma_is_bilinear_between_rings_and_sectors(
    axis: tuple[float, ...], camera: Any, tmp_path: Path
) -> None:
    sensor = SENSORS["six faces"]
    table = np.random.default_rng(2).uniform(0.1, 1.0, (4, 8, 2))
    rings = np.array([0.0, 30.0, 90.0, 180.0])
    known = Intervals(1.0, 0.95, 400, np.array(axis), rings, 8, table)
    found = replace(sensor.calibrated(camera), intervals=known)
    written(flight_code(found), tmp_path)
    made = module_of(tmp_path).solve(sensor.raw(3))
    good = made["status"] == 0
    # the same by SciPy, over angles off the axis and azimuths that close
    from scipy.interpolate import RegularGridInterpolator

    closed = np.concatenate([table, table[:, :1]], axis=1)
    places = RegularGridInterpolator((rings, np.arange(9) * 45.0), closed)
    z = np.array(axis)
    x = np.array([1.0, 0.0, 0.0]) - z[0] * z
    x /= np.linalg.norm(x)
    sun = made["sun"][good]
    off = np.degrees(np.arccos(np.clip(sun @ z, -1.0, 1.0)))
    azimuth = np.degrees(np.arctan2(sun @ np.cross(z, x), sun @ x)) % 360.0
    assert np.allclose(made["sigma_deg"][good], places((off, azimuth)), rtol=0, atol=1e-6)
    c = c_answers(tmp_path, sensor.raw(3), ())
    assert np.allclose(c[good, 6:8], places((off, azimuth)), rtol=0, atol=2e-6)


COUNTED = """
#include <cmath>
extern long operations, calls;
struct counted {
    double v;
    constexpr counted(double x = 0.0) : v(x) {}
    explicit operator int() const { return (int)v; }
    explicit operator double() const { return v; }
};
#define TWO(op) inline counted operator op(counted a, counted b) \\
    { operations++; return counted(a.v op b.v); }
#define SAME(op) inline counted &operator op##=(counted &a, counted b) \\
    { operations++; a.v op##= b.v; return a; }
#define LESS(op) inline bool operator op(counted a, counted b) { operations++; return a.v op b.v; }
TWO(+) TWO(-) TWO(*) TWO(/) SAME(+) SAME(-) SAME(*) SAME(/)
LESS(<) LESS(>) LESS(<=) LESS(>=)
inline counted operator-(counted a) { return counted(-a.v); }
#define CALL(name) inline counted name(counted a) { calls++; return counted(std::name(a.v)); }
CALL(sqrt) CALL(tan) CALL(exp) CALL(log1p) CALL(fabs)
inline counted atan2(counted a, counted b) { calls++; return counted(std::atan2(a.v, b.v)); }
typedef counted ss_real;
"""
MAIN = """
#include <cstdio>
#include "ss.c"
long operations = 0, calls = 0;
int main() {
    long most = 0, most_calls = 0;
    ss_reading in; double x; int at = 0;
    while (std::scanf("%lf", &x) == 1) {
        if (at < SS_READINGS) in.value[at] = x; else in.temperature = x;
        if (++at == INPUTS) {
            ss_answer out; at = 0; operations = calls = 0;
            ss_solve(&in, &out);
            most = operations > most ? operations : most;
            most_calls = calls > most_calls ? calls : most_calls;
        }
    }
    std::printf("%ld %ld\\n", most, most_calls);
}
"""


@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler here")
@pytest.mark.parametrize(
    "kind",
    [
        "spots",
        "four tilted cells",
        *(pytest.param(name, marks=pytest.mark.slow) for name in (*OTHERS, "warm faces")),
    ],
)
def test_the_header_bounds_the_operations_that_a_counting_number_counts(
    kind: str, camera: Any, tmp_path: Path
) -> None:
    sensor = {**SENSORS, **OTHERS}[kind]
    code = flight_code(sensor.calibrated(camera))
    texts = code.files("ss", {}, DIGEST)
    header = (
        texts["ss.h"].replace('extern "C" {', "").replace("}\n#endif\n\n#endif", "#endif\n\n#endif")
    )
    header = header.replace("typedef double ss_real;", COUNTED)
    (tmp_path / "ss.h").write_text(header)
    (tmp_path / "ss.c").write_text(texts["ss.c"])
    (tmp_path / "main.cpp").write_text(MAIN)
    rows = sensor.telemetry(3)
    inputs = rows.shape[1]
    compiled(tmp_path, "g++", "-O1", f"-DINPUTS={inputs}", "main.cpp", "-o", "count")
    text = "\n".join(" ".join(f"{value:.17g}" for value in row) for row in rows)
    operations, calls = map(int, compiled(tmp_path, "./count", input=text).split())
    assert 100 < operations <= code.program.operations
    assert 4 < calls <= code.program.calls
    iterated = "assembled" in kind or kind == "four tilted cells"
    assert iterated or code.program.operations < 2.0 * operations
    said = re.search(r"at most (\d+) additions", texts["ss.h"])
    assert said
    assert int(said[1]) == code.program.operations


@pytest.mark.parametrize("name", ["if", "json", "2nd", "é"])
def test_any_name_becomes_one_that_c_and_python_take(name: str) -> None:
    made = c_name(name)
    assert re.fullmatch(r"[a-z][a-z0-9_]*", made)
    assert made.startswith("sensor")


@pytest.mark.parametrize(
    "path",
    [r"\N{nothing}\x", 'a"""b', "a */ b /* c", "a\r\n#error\u2028x"],
)
def test_no_path_breaks_a_file(path: str, camera: Any, tmp_path: Path) -> None:
    code = flight_code(SENSORS["spots"].calibrated(camera))
    name = c_name("if")
    for file, text in code.files(name, {"Files": path, "Command": path}, DIGEST).items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    said = "import sensor_if as made; print(made.selftest()[0])"
    start = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); "
    run_ = subprocess.run(
        [sys.executable, "-I", "-W", "error", "-c", start + said],
        check=True, capture_output=True, text=True,
    )  # fmt: skip
    assert run_.stdout == "0\n"
    assert comment(path).isascii()
    if shutil.which("gcc"):
        flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"]
        compiled(tmp_path, "gcc", *flags, "-c", f"{name}.c")


@pytest.mark.skipif(shutil.which("cppcheck") is None, reason="no cppcheck here")
@pytest.mark.parametrize("kind", [pytest.param(name, marks=pytest.mark.slow) for name in SENSORS])
def test_the_code_that_flies_has_no_misra_finding(kind: str, camera: Any, tmp_path: Path) -> None:
    code = flight_code(SENSORS[kind].calibrated(camera))
    written(code, tmp_path)
    checked = ["cppcheck", "--addon=misra", "--quiet", "--std=c99", "-USS_FLOAT", "-USS_SELFTEST"]
    said = subprocess.run(
        [*checked, "ss.c"], cwd=tmp_path, check=True, capture_output=True, text=True
    )
    assert said.stderr == ""
