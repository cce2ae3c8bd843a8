"""From a file of a turntable to a verdict, a report and C code, in the browser."""

from __future__ import annotations

import shutil
import subprocess
import threading
import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from api.service import calibrations
from calibrate import uploaded
from calibrate.uploaded import UploadRefusedError
from tests.api.browser.visiting import PATIENCE_MS, Visit, follow
from tests.calibrate.bench import HEADER, grid, spots, sun_of, write

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
def test_four_actions_lead_from_home_to_a_verdict_and_code(
    visit: str,
    turntable: Path,
    tmp_path: Path,
    request: pytest.FixtureRequest,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(uploaded, "LONGEST_S", PATIENCE_MS / 1e3)  # all that is asked is tried
    visited: Visit = request.getfixturevalue(visit)
    page = visited.page
    page.goto(visited.address + "/")
    follow(page.get_by_role("link", name="Calibrate", exact=True).first)
    require_fits(page)
    page.get_by_label("Files, each a run of one sensor").set_input_files(turntable)
    expect(page.get_by_label("Role of theta_x_deg")).to_have_value("direction-1")
    expect(page.get_by_label("Role of y_px")).to_have_value("reading-2")
    expect(page.locator("#columns tbody tr")).to_have_count(6)  # roles, and five rows
    require_fits(page)
    if visit == "narrow":  # as the wide one, sooner
        page.locator("details:has([name=model]) > summary").click()
        page.get_by_label("Model, such as").fill("homography")
        require_fits(page)
    page.get_by_role("button", name="Calibrate", exact=True).click()
    expect(page.get_by_role("heading", name="Models compared")).to_be_visible()
    expect(page.locator(".verdict")).to_contain_text("good")
    expect(page.locator("figure svg")).to_have_count(5)
    expect(page.get_by_label("Role of y_px")).to_be_visible()  # the form stays
    require_fits(page)
    with page.expect_download() as coming:
        page.get_by_role("link", name="Download all files").click()
    coming.value.save_as(tmp_path / "all.zip")
    with zipfile.ZipFile(tmp_path / "all.zip") as archive:
        archive.extractall(tmp_path)
    assert (tmp_path / "sun_sensor_report.html").read_text().count("<svg") == 5
    assert visited.complaints == []
    if shutil.which("gcc"):
        names = ["sun_sensor.c", "sun_sensor_selftest.c"]
        flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-DSUN_SENSOR_SELFTEST"]
        subprocess.run(["gcc", *flags, *names, "-o", "test", "-lm"], cwd=tmp_path, check=True)
        subprocess.run(["./test"], cwd=tmp_path, check=True, capture_output=True)


def test_a_wrong_file_is_refused_beside_the_form_which_stays(narrow: Visit, tmp_path: Path) -> None:
    page = narrow.page
    wrong = tmp_path / "wrong.csv"
    wrong.write_text("x_px,y_px,theta_x_deg,theta_y_deg\n1,b,3,4\n")
    page.goto(narrow.address + "/calibrate")
    page.get_by_label("Requirement on the error").fill("0.1deg@rms")
    page.get_by_label("Files, each a run of one sensor").set_input_files(wrong)
    page.get_by_role("button", name="Calibrate", exact=True).click()
    said = page.get_by_role("alert")
    expect(said).to_contain_text("row 2, column y_px: expected a number; got 'b'")
    expect(page.get_by_label("Requirement on the error")).to_have_value("0.1deg@rms")
    assert page.get_by_label("Files, each a run of one sensor").evaluate("e => e.files.length") == 1
    require_fits(page)


def test_who_waits_reads_how_many_come_first_and_how_long_that_takes(
    narrow: Visit, turntable: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    may_end = threading.Event()

    def calibrate(*_: object, **__: object) -> None:
        may_end.wait()
        raise UploadRefusedError("as all before it")

    monkeypatch.setattr(calibrations, "calibrate_uploads", calibrate)
    page = narrow.page
    page.goto(narrow.address + "/calibrate")
    page.get_by_label("Files, each a run of one sensor").set_input_files(turntable)
    expect(page.get_by_label("Role of y_px")).to_have_value("reading-2")
    try:
        page.evaluate(
            """async () => {
                 const form = new FormData();
                 form.set("file", new File(["1"], "b.csv"));
                 for (const _ of "12") fetch("/v1/calibrations", { method: "POST", body: form });
               }"""
        )
        while calibrations._CALIBRATIONS.length < 2:
            page.wait_for_timeout(10)
        page.get_by_role("button", name="Calibrate", exact=True).click()
        expect(page.locator("#progress")).to_contain_text("2 in front, about 20 s")
        require_fits(page)
    finally:
        may_end.set()
    expect(page.get_by_role("alert")).to_contain_text("as all before it")


def test_the_sample_is_calibrated_without_a_script(browser: Browser, address: str) -> None:
    """The page that is sent holds form, report and archive."""
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)
    page.goto(address + "/calibrate?model=homography")
    page.get_by_role("button", name="Try with the sample").click()
    expect(page.get_by_role("heading", name="Models compared")).to_be_visible()
    expect(page.get_by_role("link", name="Download all files")).to_be_visible()
    expect(page.get_by_label("Model, such as")).to_have_value("homography")
    context.close()
