"""Pictures in a directory, named by a table of poses, calibrate a camera."""

from __future__ import annotations

import os
import struct
from pathlib import Path

import cv2
import numpy as np
import pytest
from bench import grid, sun_of

from calibrate.calibration import calibrate
from calibrate.forms.pictures import picture_size
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


@pytest.mark.parametrize(
    "suffix", [".png", ".jpg", ".bmp", ".tiff", ".pgm", ".ppm", ".webp", ".jp2"]
)
def test_the_size_of_a_picture_is_that_of_its_head(suffix: str) -> None:
    """OpenCV reads more forms than those whose heads are read first, and which are taken."""
    made = np.zeros((37, 211) if suffix == ".pgm" else (37, 211, 3), dtype=np.uint8)
    whole, file = cv2.imencode(suffix, made)
    assert whole
    known = None if suffix in {".webp", ".jp2"} else (211, 37)
    assert picture_size(file.tobytes()) == known
    if known:
        assert all(picture_size(file.tobytes()[:end]) in {None, known} for end in range(300))


HEADS = {
    "png": b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR" + struct.pack(">II", 50_000, 50_000),
    "bmp": b"BM" + bytes(12) + struct.pack("<Iii", 40, 50_000, -50_000),
    "bmp of OS/2": b"BM" + bytes(12) + struct.pack("<IHH", 12, 50_000, 50_000),
    "jpeg": b"\xff\xd8\xff\xe1\0\x06\xff\xc0ab\xff\xff\xc2"
    + struct.pack(">HBHH", 17, 8, 50_000, 50_000),
    "tiff": struct.pack("<2sHIH", b"II", 42, 8, 2)
    + struct.pack("<HHII", 256, 4, 1, 50_000)
    + struct.pack("<HHIHH", 257, 3, 1, 50_000, 0),
    "tiff in tiles": struct.pack(">2sHIH", b"MM", 42, 8, 4)
    + b"".join(struct.pack(">HHII", tag, 4, 1, 60) for tag in (256, 257))
    + b"".join(struct.pack(">HHII", tag, 4, 1, 50_000) for tag in (322, 323)),
    "large tiff": struct.pack("<2sHHHQQ", b"II", 43, 8, 0, 16, 2)
    + b"".join(struct.pack("<HHQQ", tag, 16, 1, 50_000) for tag in (256, 257)),
    "pgm": b"P5# 3 3\n\t50000 #4\r50000\n255\n",
}  # fmt: skip


@pytest.mark.parametrize(
    "head",
    [
        b"\xff\xd8\xff\0" + struct.pack(">HHBHH", 9, 0xFFC0, 8, 9, 9) + HEADS["jpeg"][2:],
        HEADS["tiff"].replace(struct.pack("<HH", 257, 3), struct.pack("<HH", 257, 9)),
        HEADS["png"].replace(b"IHDR", b"pHYs"),
    ],
    ids=["jpeg", "tiff", "png"],
)
def test_a_head_that_decoders_read_in_different_ways_is_that_of_no_picture(head: bytes) -> None:
    assert picture_size(head) is None


@pytest.mark.parametrize("form", HEADS)
def test_a_picture_of_too_many_pixels_is_refused_before_a_pixel_is_decoded(
    form: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("pixels are decoded"))
    path = tmp_path / "large.png"
    path.write_bytes(HEADS[form])
    with pytest.raises(TableError, match=r"row 2: .* 100000000 pixels; got 50000 x 50000 pixels"):
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
