"""From a file of a turntable to a verdict, a report and C code, in the browser."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from tests.api.browser.visiting import Visit
from tests.api.calibrate.bench import HEADER, grid, spots, sun_of, write

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def turntable(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small camera behind a pinhole."""
    angles = grid(15, 40.0)
    path = tmp_path_factory.mktemp("bench") / "bench.csv"
    return write(path, HEADER, spots(sun_of(angles), 1), angles)


def require_fits(page: Page) -> None:
    """Nothing reaches beyond the window, but what scrolls in its own box."""
    page.wait_for_load_state()  # the style sheet comes after the text
    assert page.evaluate("document.documentElement.scrollWidth") <= page.viewport_size["width"]


@pytest.mark.parametrize("visit", ["wide", "narrow"])
def test_a_file_becomes_a_verdict_and_code(
    visit: str, turntable: Path, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    visited: Visit = request.getfixturevalue(visit)
    page = visited.page
    page.goto(visited.address + "/calibrate")
    require_fits(page)
    page.get_by_label("Files, each a run of one sensor").set_input_files(turntable)
    page.get_by_role("button", name="Calibrate").click()
    expect(page.locator("body")).to_contain_text("good")
    expect(page.get_by_role("heading", name="Models compared")).to_be_visible()
    expect(page.locator("figure svg")).to_have_count(4)
    require_fits(page)

    page.go_back()
    page.get_by_label("Files, each a run of one sensor").set_input_files(turntable)
    page.get_by_label("Answer with").select_option("zip")
    with page.expect_download() as coming:
        page.get_by_role("button", name="Calibrate").click()
    coming.value.save_as(tmp_path / "all.zip")
    with zipfile.ZipFile(tmp_path / "all.zip") as archive:
        archive.extractall(tmp_path)
    assert (tmp_path / "sun_sensor_report.html").read_text().count("<svg") == 4
    if shutil.which("gcc"):
        names = ["sun_sensor.c", "sun_sensor_selftest.c"]
        flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-DSUN_SENSOR_SELFTEST"]
        subprocess.run(["gcc", *flags, *names, "-o", "test", "-lm"], cwd=tmp_path, check=True)
        subprocess.run(["./test"], cwd=tmp_path, check=True, capture_output=True)


def test_a_wrong_file_is_refused_with_its_row_and_column(narrow: Visit, tmp_path: Path) -> None:
    page = narrow.page
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("x_px,y_px,theta_x_deg,theta_y_deg\n1,b,3,4\n")
    page.goto(narrow.address + "/calibrate")
    page.get_by_label("Files, each a run of one sensor").set_input_files(wrong)
    page.get_by_role("button", name="Calibrate").click()
    expect(page.locator("main")).to_contain_text("row 2, column y_px: expected a number; got 'b'")
    require_fits(page)
