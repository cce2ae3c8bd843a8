"""Pictures in a directory, named by a table of poses, calibrate a camera."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import pytest
from bench import grid, sun_of

from calibrate.calibration import calibrate
from calibrate.settings import Settings, SettingsError
from calibrate.sources import SPOT, with_spots
from calibrate.table import Table, TableError

CASES = Path(os.environ.get("SUNATLAS_CASES", Path(__file__).parents[3] / "shared" / "cases"))
ANGLES = grid(9, 20.0)
FOCAL, MIDDLE = 60.0, (39.5, 29.5)


def picture(sun: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A disc behind a pinhole, 60 rows of 80 pixels."""
    y, x = np.mgrid[:60, :80]
    at = MIDDLE + FOCAL * sun[:2] / sun[2]
    disc = 180.0 / (1.0 + np.exp(2.0 * (np.hypot(x - at[0], y - at[1]) - 5.0)))
    return np.asarray(rng.normal(20.0 + disc, 2.0).clip(0, 255).round().astype(np.uint8))


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


def test_frames_of_a_directory_are_measured_and_calibrate(tmp_path: Path) -> None:
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
def test_a_picture_that_is_none_is_named_by_its_row(name: str, said: str, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "poses.csv").write_text(f"image,theta_x_deg,theta_y_deg\n{name},1,2\n")
    with pytest.raises(TableError, match=f"row 2: .*{said}"):
        calibrate([run])


def settings(column: str = "image", **readings: object) -> Settings:
    return Settings.model_validate(
        {
            "readings": {"kind": "frames", "columns": [column], **readings},
            "direction": {"form": "alpha-inner", "columns": ["theta_x_deg", "theta_y_deg"]},
        }
    )


def named(*names: str) -> Table:
    return Table({"image": np.array(names)}, 2, "poses.csv", {})


def test_grey_frames_give_their_spots_and_no_word_of_colour(tmp_path: Path) -> None:
    run = folder(tmp_path / "run")
    told: list[tuple[int, int]] = []
    made, said = with_spots(
        named("40.png", "44.png"), run, settings(), lambda *done: told.append(done)
    )
    for at, number in enumerate((40, 44)):
        sun = sun_of(ANGLES)[number]
        spot = [made.columns[name][at] for name in SPOT]
        assert spot == pytest.approx(MIDDLE + FOCAL * sun[:2] / sun[2], abs=0.3)
    assert said == ["2 frames were read by mirror"]
    assert told == [(1, 2), (2, 2)]


@pytest.mark.parametrize(
    ("extractor", "said"),
    [
        ("voltage-balance", r"one that finds a spot in frames \(.*mirror.*\); got 'voltage-balanc"),
        ("feic", "readings.extractor: feic needs the sensor geometry's focal_length_mm"),
    ],
)
def test_an_extractor_that_finds_no_spot_in_these_frames_is_refused(
    extractor: str, said: str, tmp_path: Path
) -> None:
    with pytest.raises(SettingsError, match=said):
        with_spots(named("0.png"), tmp_path, settings(extractor=extractor))


def one_picture(directory: Path, *pictures: Path | np.ndarray) -> tuple[Table, list[str]]:
    """The table of pictures in a directory of their own, with their spots."""
    directory.mkdir()
    for number, one in enumerate(pictures):
        path = directory / f"{number}.png"
        if isinstance(one, Path):
            path.write_bytes(one.read_bytes())
        else:
            assert cv2.imwrite(str(path), one)
    names = np.array([f"{number}.png" for number in range(len(pictures))])
    table = Table({"image": names}, 2, "poses.csv", {"image": (2, "0.png")})
    settings = Settings.model_validate(
        {
            "readings": {"kind": "frames", "columns": ["image"]},
            "direction": {"form": "projection", "columns": ["a", "b"]},
        }
    )
    return with_spots(table, directory, settings)


def test_a_picture_of_another_size_is_refused_by_its_row(tmp_path: Path) -> None:
    sun = sun_of(np.array([[0.0, 0.0]]))[0]
    usual = picture(sun, np.random.default_rng(1))
    with pytest.raises(TableError, match=r"row 3: expected a picture of 80 x 60 .*; got 80 x 50"):
        one_picture(tmp_path / "run", usual, usual[:50])


def test_a_picture_of_too_many_pixels_is_refused(tmp_path: Path) -> None:
    import struct
    import zlib

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 0, 0, 0, 0)
    path = tmp_path / "large.png"
    path.write_bytes(
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")
    )
    with pytest.raises(TableError, match="row 2: expected a picture of at most 100000000 pixels"):
        one_picture(tmp_path / "run", path)


def test_links_in_a_circle_are_no_picture(tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "a.png").symlink_to(run / "b.png")
    (run / "b.png").symlink_to(run / "a.png")
    (run / "poses.csv").write_text("image,theta_x_deg,theta_y_deg\na.png,1,2\n")
    with pytest.raises(TableError, match=r"row 2: expected a picture; got no file 'a\.png'"):
        calibrate([run])


@pytest.mark.skipif(not CASES.is_dir(), reason="no ../shared beside this checkout")
def test_colour_is_said_and_a_saturated_disc_flagged(tmp_path: Path) -> None:
    table, said = one_picture(tmp_path / "colour", CASES / "colour-disc.png")
    assert len(table.columns[SPOT[0]]) == 1
    assert any("1 frames in colour" in note for note in said), said
    table, said = one_picture(tmp_path / "clipped", CASES / "half-saturated-disc.png")
    assert any("1 frames may be saturated" in note for note in said)
