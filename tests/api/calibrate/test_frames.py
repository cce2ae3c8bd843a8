"""Pictures in a directory, named by a table of poses, calibrate a camera."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from bench import grid, sun_of

from api.calibrate.calibration import calibrate
from api.calibrate.table import TableError

ANGLES = grid(9, 20.0)
FOCAL, MIDDLE = 60.0, (39.5, 29.5)


def picture(sun: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A disc behind a pinhole, 60 rows of 80 pixels."""
    y, x = np.mgrid[:60, :80]
    at = MIDDLE + FOCAL * sun[:2] / sun[2]
    disc = 180.0 / (1.0 + np.exp(2.0 * (np.hypot(x - at[0], y - at[1]) - 5.0)))
    return rng.normal(20.0 + disc, 2.0).clip(0, 255).round().astype(np.uint8)


def folder(path: Path, colour: int | None = None) -> Path:
    path.mkdir()
    rng = np.random.default_rng(2)
    rows = ["image,theta_x_deg,theta_y_deg"]
    for number, (angles, sun) in enumerate(zip(ANGLES, sun_of(ANGLES), strict=True)):
        frame = picture(sun, rng)
        if number == colour:
            frame = np.stack([frame, frame // 2, frame], axis=2)
        assert cv2.imwrite(str(path / f"{number}.png"), frame)
        rows.append(f"{number}.png,{angles[0]},{angles[1]}")
    (path / "poses.csv").write_text("\n".join(rows) + "\n")
    return path


def test_frames_of_a_directory_are_measured_and_calibrate(tmp_path):
    found = calibrate([folder(tmp_path / "run", colour=7)], models=("homography", "pinhole"))
    assert len(found.readings) + len(found.excluded) == len(ANGLES)
    assert found.chosen.rms_deg < 0.1  # a tenth of a pixel
    assert any(note.startswith("81 ") and "mirror" in note for note in found.notes)
    assert any(note.startswith("1 ") and "colour" in note for note in found.notes)
    assert found.settings.readings.kind == "spot"


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("9.png", "no picture"),
        ("../poses.csv", "expected a picture in"),
        ("poses.csv", "expected a PNG"),
    ],
)
def test_a_picture_that_is_none_is_named_by_its_row(name, said, tmp_path):
    run = tmp_path / "run"
    run.mkdir()
    (run / "poses.csv").write_text(f"image,theta_x_deg,theta_y_deg\n{name},1,2\n")
    with pytest.raises(TableError, match=f"row 2: .*{said}"):
        calibrate([run])


def test_a_directory_of_two_tables_is_refused(tmp_path):
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("x")
    with pytest.raises(TableError, match=r"expected one table .*a.csv, b.csv"):
        calibrate([tmp_path])
